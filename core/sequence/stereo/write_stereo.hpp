#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/sequence/source.hpp"
#include "core/sequence/write_sequence.hpp"

namespace stillpoint {

/// Where a layout has the images of a stereo sequence.
struct StereoNames {
  std::filesystem::path left, right;  ///< in the sequence's folder
};
[[nodiscard]] StereoNames stereo_names(const FrameSource& source, int index, SequenceLayout layout);

/// The folders and files that a stereo layout writes beside masks, ground truth in the TUM layout and
/// camera.toml: by what an earlier one is known and cleared.
[[nodiscard]] const std::vector<std::string>& stereo_image_folders();
[[nodiscard]] const std::vector<std::string>& stereo_text_files();

/// Calibration, times and ground truth of a stereo sequence whose images are written.
/// @param frames how many of them
/// @throws InputError for what cannot be written
void write_stereo_texts(const FrameSource& source, const std::filesystem::path& folder, int frames,
                        SequenceLayout layout);

}  // namespace stillpoint
