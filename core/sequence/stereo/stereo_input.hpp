#pragma once

#include <memory>

#include "core/sequence/sequence_input.hpp"

namespace stillpoint {

/// The input of a stereo recording (stereo_recording.hpp): its lists name left images, and right ones in the
/// place of depth; images come rectified. Null where the folder is none, and `files` is left as it is.
/// @throws InputError for one that cannot be used
[[nodiscard]] std::unique_ptr<SequenceInput> make_stereo_input(std::unique_ptr<FileStore>& files,
                                                               const OpenOptions& options);

}  // namespace stillpoint
