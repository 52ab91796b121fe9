#pragma once

#include <memory>

#include "core/sequence/sequence_input.hpp"

namespace stillpoint {

/// An RGB-D recording of another layout (rgbd_recording.hpp), of a folder or an archive of one.
/// @param files is taken where it is one
/// @return null where it is none
/// @throws InputError for one that cannot be used
[[nodiscard]] std::unique_ptr<SequenceInput> make_rgbd_input(std::unique_ptr<FileStore>& files,
                                                             const OpenOptions& options);

}  // namespace stillpoint
