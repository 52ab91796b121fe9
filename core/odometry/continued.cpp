// Going on from the middle of a run: with another config, or from a copy that was put by.
#include <limits>

#include "core/odometry/odometry.hpp"

namespace stillpoint {

void Odometry::drop_images() {
  preparer_.motion().forget();
  motion_.drop_images();
  for (auto* reference : {&last_reference_, &sharp_reference_})
    if (*reference) (*reference)->gray.release(), (*reference)->depth.release();
}

void Odometry::restore_images(int next, const std::function<Frame(int)>& read) {
  preparer_.motion().restore(next, config_.run.threads, read);
  motion_.restore_images(next, std::numeric_limits<int>::max(), read);
  for (auto* reference : {&last_reference_, &sharp_reference_}) {
    // One that is too old for the next frame is never looked at again.
    if (!*reference || !(*reference)->gray.empty() ||
        next - (*reference)->frame_index > config_.direct.max_age)
      continue;
    const Frame frame = read((*reference)->frame_index);
    (*reference)->gray = frame.gray;
    (*reference)->depth = frame.depth;
  }
}

int Odometry::frames_wanted(const Config& config) const { return motion_.frames_wanted(config); }

std::optional<Odometry> Odometry::continued_with(const Config& config,
                                                 const std::vector<PastFrame>& before) const {
  if (config.features.levels != config_.features.levels ||
      config.features.scale_factor != config_.features.scale_factor)
    return std::nullopt;
  Odometry next = *this;
  next.config_ = config;
  next.preparer_ = FramePreparer(camera_, config);
  if (!next.looks_back()) next.hindsight_.forget_pending();
  next.motion_ = motion_.continued_with(config, before);
  if (frames_wanted(config) == 0) {
    for (const auto& preparation : preparer_.motion().past()) next.preparer_.motion().pass(preparation);
  } else {
    for (const PastFrame& past : before)
      if (past.frame.readable()) (void)next.preparer_.motion().prepare(past.frame, config.run.threads);
  }
  return next;
}

}  // namespace stillpoint
