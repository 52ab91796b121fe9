#pragma once

#include <memory>
#include <string>

#include "core/sequence/sequence_input.hpp"

namespace stillpoint {

/// Whether a file is a video by its first bytes: MP4 or MOV, Matroska or WebM, AVI.
[[nodiscard]] bool is_video(const std::string& path);

/// A video as a sequence of colour images without depth, at the stamps of the file. It is gone through once
/// on opening.
/// @throws InputError for one of which no frame can be decoded, and where the module for videos is missing
[[nodiscard]] std::unique_ptr<SequenceInput> make_video_input(const std::string& path,
                                                              const OpenOptions& options);

}  // namespace stillpoint
