#pragma once

#include <functional>
#include <memory>
#include <vector>

namespace stillpoint {

struct FrameRecord;
struct FrameView;

// What a frame's view holds of the frames before it.

inline constexpr int kHistoryFrames = 12;  // frames: enough to see where a feature came from

/// The records of the frames right before `index`, newest first.
/// @param record gives a processed frame's record with its features
[[nodiscard]] std::vector<std::shared_ptr<const FrameRecord>> history_of(
    int index, const std::function<FrameRecord(int)>& record);

/// A view with its record, without what it holds of frames before: what another view holds of it.
[[nodiscard]] std::shared_ptr<const FrameView> alone(const FrameView& view);

/// Takes the wall times out of a view, so that images repeat byte for byte.
void clear_times(FrameView& view);

}  // namespace stillpoint
