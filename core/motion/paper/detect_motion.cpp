#include "core/motion/paper/detect_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <future>
#include <optional>

#include "core/error.hpp"
#include "core/motion/paper/cleanup.hpp"
#include "core/motion/paper/compensation.hpp"
#include "core/motion/paper/difference.hpp"
#include "core/motion/paper/homography.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

/// A mask of more than this share of the frame says more about the homography than about what is dynamic.
constexpr double kDoubtfulShare = 0.5;

/// Runs two independent steps, beside each other when there are threads for it.
template <typename First, typename Second>
void run_both(int threads, First first, Second second) {
  if (threads < 2) {
    first();
    second();
    return;
  }
  auto beside = std::async(std::launch::async, second);
  first();
  beside.get();
}

void check_frame(const cv::Mat& gray, const char* role) {
  if (gray.type() != CV_8UC1 || gray.empty())
    throw InputError(fmt::format("motion detection wants an 8-bit grey {} frame, and was given {}", role,
                                 gray.empty() ? "none" : cv::typeToString(gray.type())));
}

void check_pair(const cv::Mat& reference, const cv::Mat& target) {
  check_frame(reference, "reference");
  check_frame(target, "target");
  if (reference.size() != target.size())
    throw InputError(
        fmt::format("the reference frame is {}x{} and the target frame {}x{}: they must be of one size",
                    reference.cols, reference.rows, target.cols, target.rows));
}

/// Steps 2 to 4 in one direction, from `source` into the camera of `destination`.
/// @param last the homography of the round before; without one and without a new one there are no images
DirectionTrace look_one_way(std::vector<Track> tracks, const cv::Mat& source, const cv::Mat& destination,
                            const std::optional<cv::Matx33d>& last, const PaperConfig& config) {
  DirectionTrace seen;
  seen.tracks = std::move(tracks);
  Stopwatch watch;
  seen.homography = estimate_homography(seen.tracks, source.size(), config,
                                        last.value_or(cv::Matx33d::eye()));  // eqs. (3), (4)
  seen.ms.homography = watch.lap();
  if (!seen.homography.valid && !last) return seen;
  CompensatedFrame carried = compensate(source, seen.homography.matrix, config.border_px);
  seen.compensated = carried.image;
  seen.valid = carried.valid;
  if (config.follow_exposure) {
    seen.exposure = exposure_ratio(destination, seen.compensated, seen.valid);
    if (seen.exposure != 1.0) seen.compensated.convertTo(seen.compensated, CV_8U, seen.exposure);
  }
  seen.ms.compensation = watch.lap();
  seen.difference = frame_difference(destination, seen.compensated, seen.valid);  // eq. (1)
  seen.ms.difference = watch.lap();
  seen.threshold = otsu_threshold(histogram(seen.difference, seen.valid));
  seen.raw_mask = binarise(seen.difference, seen.threshold);  // eq. (2)
  seen.ms.threshold = watch.lap();
  seen.mask = clean_mask(seen.raw_mask, seen.valid, config);
  seen.ms.cleanup = watch.lap();
  return seen;
}

/// What a direction sees whose tracks are those of the round before: the same, at no time.
DirectionTrace seen_again(const DirectionTrace& before) {
  DirectionTrace seen = before;
  seen.ms = {};
  return seen;
}

/// Step 5. The backward mask lies in the reference's camera; the forward homography brings it into the
/// target's (the inverse of the backward one, where there is no forward one), and what the forward warp has
/// no data for stays out of the union. Step 6's regions are found when somebody looks (describe_paper): what
/// they hold is what the mask holds.
void unite_directions(MotionRound& round) {
  const DirectionTrace& forward = round.forward;
  const DirectionTrace& backward = round.backward;
  if (!backward.mask.empty()) {
    const cv::Matx33d target_from_reference =
        forward.mask.empty() ? backward.homography.matrix.inv() : forward.homography.matrix;
    round.backward_mask_in_target = warp_mask(backward.mask, target_from_reference);
    if (!forward.valid.empty())
      cv::bitwise_and(round.backward_mask_in_target, forward.valid, round.backward_mask_in_target);
  }
  if (forward.mask.empty()) {
    round.mask = round.backward_mask_in_target.clone();
  } else if (backward.mask.empty()) {
    round.mask = forward.mask.clone();
  } else {
    cv::bitwise_or(forward.mask, round.backward_mask_in_target, round.mask);
  }
  if (round.mask.empty()) return;
  round.mask_share =
      static_cast<double>(cv::countNonZero(round.mask)) / static_cast<double>(round.mask.total());
}

std::optional<cv::Matx33d> last_homography(const std::vector<MotionRound>& rounds,
                                           DirectionTrace MotionRound::*direction) {
  if (rounds.empty() || (rounds.back().*direction).mask.empty()) return std::nullopt;
  return (rounds.back().*direction).homography.matrix;
}

bool homographies_settled(const MotionRound& before, const MotionRound& now, const PaperConfig& config) {
  const cv::Size size = now.mask.size();
  const auto settled = [&](DirectionTrace MotionRound::*direction) {
    const DirectionTrace& old = before.*direction;
    const DirectionTrace& latest = now.*direction;
    if (old.mask.empty() != latest.mask.empty()) return false;
    return latest.mask.empty() ||
           corner_shift_px(old.homography.matrix, latest.homography.matrix, size) < config.converged_shift_px;
  };
  return settled(&MotionRound::forward) && settled(&MotionRound::backward);
}

int count_static(const DirectionTrace& direction) {
  return static_cast<int>(std::count_if(direction.tracks.begin(), direction.tracks.end(),
                                        [](const Track& track) { return !track.removed; }));
}

/// Why there is no mask, or why it is to be doubted.
std::string note_on(const PaperTrace& trace, const PaperConfig& config) {
  const MotionRound& round = trace.rounds.back();
  const DirectionTrace& forward = round.forward;
  const DirectionTrace& backward = round.backward;
  const std::string counts =
      fmt::format("{} static tracks forward and {} backward, at least {} wanted on one plane or one rotation",
                  count_static(forward), count_static(backward), config.min_tracks);
  if (round.mask.empty()) return "no mask: no homography fits in either direction (" + counts + ")";
  if (forward.mask.empty() || backward.mask.empty())
    return fmt::format("the {} direction found no homography: the mask is the other's alone ({})",
                       forward.mask.empty() ? "forward" : "backward", counts);
  if (!forward.homography.valid || !backward.homography.valid)
    return fmt::format("round {} keeps the last {} homography: after removal none fits ({})",
                       trace.rounds.size(),
                       !forward.homography.valid && !backward.homography.valid ? "forward and backward"
                       : !forward.homography.valid                             ? "forward"
                                                                               : "backward",
                       counts);
  if (round.mask_share > kDoubtfulShare)
    return fmt::format("the mask takes {:.0f} % of the frame: one homography does not explain this pair",
                       100.0 * round.mask_share);
  return {};
}

}  // namespace

PaperTrace detect_motion(const MotionFrame& reference, const MotionFrame& target, const PaperConfig& config,
                         int threads) {
  check_pair(reference.gray, target.gray);
  PaperTrace trace;
  if (std::min(target.gray.cols, target.gray.rows) < kMinMotionSide) {
    trace.note = fmt::format("no mask: frames of {}x{} are too small, at least {}x{} is wanted",
                             target.gray.cols, target.gray.rows, kMinMotionSide, kMinMotionSide);
    return trace;
  }
  std::vector<Track> forward_tracks, backward_tracks;
  Stopwatch watch;
  run_both(
      threads, [&] { forward_tracks = follow_corners(reference, target, config); },
      [&] { backward_tracks = follow_corners(target, reference, config); });
  trace.tracks_ms = watch.milliseconds();

  // A direction none of whose tracks changed sides would see again what it saw.
  int forward_changed = 0, backward_changed = 0;
  for (int i = 0; i < config.max_rounds; ++i) {  // fig. 2
    MotionRound round;
    const auto last_forward = last_homography(trace.rounds, &MotionRound::forward);
    const auto last_backward = last_homography(trace.rounds, &MotionRound::backward);
    const auto look_forward = [&] {
      if (i > 0 && forward_changed == 0)
        round.forward = seen_again(trace.rounds.back().forward);
      else
        round.forward = look_one_way(forward_tracks, reference.gray, target.gray, last_forward, config);
    };
    const auto look_backward = [&] {
      if (i > 0 && backward_changed == 0)
        round.backward = seen_again(trace.rounds.back().backward);
      else
        round.backward = look_one_way(backward_tracks, target.gray, reference.gray, last_backward, config);
    };
    run_both(threads, look_forward, look_backward);
    watch.lap();
    unite_directions(round);
    round.union_ms = watch.lap();
    trace.rounds.push_back(std::move(round));

    const cv::Mat& mask = trace.rounds.back().mask;
    const bool settled =
        i > 0 && homographies_settled(trace.rounds[trace.rounds.size() - 2], trace.rounds.back(), config);
    watch.lap();
    forward_changed = remove_moving_tracks(forward_tracks, TrackEnd::kTo, mask);
    backward_changed = remove_moving_tracks(backward_tracks, TrackEnd::kFrom, mask);
    trace.rounds.back().removal_ms = watch.lap();
    trace.rounds.back().changed_tracks = forward_changed + backward_changed;
    trace.converged = settled || trace.rounds.back().changed_tracks == 0;
    if (trace.converged) break;
  }
  trace.note = note_on(trace, config);
  return trace;
}

PaperTrace detect_motion(const cv::Mat& reference, const cv::Mat& target, const PaperConfig& config,
                         int threads) {
  check_pair(reference, target);
  MotionFrame ready_reference, ready_target;
  run_both(
      threads, [&] { ready_reference = prepare_motion_frame(reference, config); },
      [&] { ready_target = prepare_motion_frame(target, config); });
  return detect_motion(ready_reference, ready_target, config, threads);
}

}  // namespace stillpoint
