#include "core/inspect/run_view.hpp"

#include "core/run/frame_figures.hpp"

namespace stillpoint {

MeasuredFrames RunView::measured() const { return {records, &evaluation, &scores, columns.get()}; }

}  // namespace stillpoint
