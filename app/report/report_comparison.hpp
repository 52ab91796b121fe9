#pragma once

#include <string>
#include <vector>

#include "app/report/report_pictures.hpp"

namespace stillpoint {

// The parts of a report that set runs side by side: where they went, what each saw in one frame, and what
// each is of.

/// The paths of all runs of a sequence in one picture and at one scale, and their positions and angles over
/// time, beside the ground truth. Runs are laid onto the truth where there is one.
[[nodiscard]] std::string paths_compared(const ReportGroup& group);

/// The frame that is worst in any of the runs as each of them saw it.
[[nodiscard]] std::string one_frame_compared(Painter& painter, const ReportGroup& group,
                                             const ReportProgress& progress);

/// What made the page, when and where; and of each run its sequence, camera and hash, whether removal helped
/// and how its masks agree with the true ones.
[[nodiscard]] std::string provenance(const std::vector<ReportGroup>& groups);

}  // namespace stillpoint
