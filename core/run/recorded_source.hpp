#pragma once

#include <memory>
#include <string>

#include "core/run/records_file.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {

/// Stands in for a run's sequence when that is gone: stamps, camera and ground truth are known from the
/// run's records; each frame comes without images and says why.
/// @param why one sentence
[[nodiscard]] std::unique_ptr<FrameSource> make_recorded_source(std::shared_ptr<const RecordedRun> run,
                                                                const std::string& why);

}  // namespace stillpoint
