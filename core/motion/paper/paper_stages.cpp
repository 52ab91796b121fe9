#include "core/motion/paper/paper_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/median.hpp"
#include "core/motion/paper/compensation.hpp"
#include "core/motion/paper/homography.hpp"
#include "core/motion/regions.hpp"

namespace stillpoint {
namespace {

double count_tracks(const DirectionTrace& direction, bool Track::*which) {
  return static_cast<double>(std::count_if(direction.tracks.begin(), direction.tracks.end(),
                                           [which](const Track& track) { return track.*which; }));
}

bool is_set(const cv::Mat& mask, const cv::Point2f& place) {
  const int x = cvRound(place.x), y = cvRound(place.y);
  return x >= 0 && y >= 0 && x < mask.cols && y < mask.rows && mask.at<std::uint8_t>(y, x) != 0;
}

std::vector<Mark> track_marks(const DirectionTrace& direction, bool judged, bool static_only = false) {
  std::vector<Mark> marks;
  for (const Track& track : direction.tracks) {
    if (static_only && track.removed) continue;
    const MarkKind kind = !judged         ? MarkKind::kKept
                          : track.removed ? MarkKind::kRemoved
                          : track.inlier  ? MarkKind::kInlier
                                          : MarkKind::kOutlier;
    marks.push_back({track.to, track.from, kind});
  }
  return marks;
}

/// The paper's steps of one pair of frames, added to a log.
class PaperStages {
 public:
  PaperStages(const Frame& frame, const PaperMotionTrace& trace, StageLog& log)
      : trace_(trace.pair),
        log_(log),
        target_(photo_layer(fmt::format("Frame {}", frame.index), frame.gray)),
        reference_(photo_layer(fmt::format("Frame {}", trace.reference), trace.reference_gray,
                               FrameSpace::kReference)) {}

  void add_all() {
    add_tracks();
    for (std::size_t i = 0; i < trace_.rounds.size(); ++i) {
      round_ = static_cast<int>(i);
      add_warp(trace_.rounds[i], i > 0 ? &trace_.rounds[i - 1] : nullptr);
      add_masks(trace_.rounds[i], i + 1 == trace_.rounds.size());
    }
    std::string& note = log_.stages.back().note;
    note += (note.empty() || trace_.note.empty() ? "" : " ") + trace_.note;
  }

 private:
  static const DirectionTrace& direction_of(const MotionRound& round, bool forward) {
    return forward ? round.forward : round.backward;
  }
  [[nodiscard]] const Layer& destination(bool forward) const { return forward ? target_ : reference_; }
  [[nodiscard]] const Layer& source(bool forward) const { return forward ? reference_ : target_; }
  static std::string named(const char* name, bool forward) {
    return std::string(name) + (forward ? "" : "_backward");
  }

  Stage& add_round(const char* id, const char* name, const char* what) {
    Stage& stage = log_.add(id, fmt::format("Round {}", round_ + 1), name, what);
    stage.round = round_;
    return stage;
  }

  /// Adds both directions' sides. @param make (direction, forward) -> StageSide
  template <typename Make>
  static void add_sides(Stage& stage, const MotionRound& round, const Make& make) {
    for (const bool forward : {true, false}) {
      StageSide side = make(direction_of(round, forward), forward);
      side.name = forward ? "Forward" : "Backward";
      stage.sides.push_back(std::move(side));
    }
  }

  [[nodiscard]] Layer compensated_layer(const DirectionTrace& direction, bool forward) const {
    Layer layer = photo_layer("Compensated", direction.compensated,
                              forward ? FrameSpace::kCompensatedForward : FrameSpace::kCompensatedBackward);
    layer.id = named("compensated", forward);
    layer.valid = direction.valid;
    layer.ground = destination(forward).image;
    return layer;
  }

  [[nodiscard]] Layer difference_layer(const DirectionTrace& direction, bool forward) const {
    Layer layer;
    layer.name = "Difference";
    layer.id = named("difference", forward);
    layer.kind = LayerKind::kLevels;
    layer.image = direction.difference;
    layer.valid = direction.valid;
    // Three times the threshold tells most apart; what is above is as bright as can be.
    layer.range = std::clamp(3.0 * direction.threshold, 30.0, 255.0);
    layer.limit = direction.threshold;
    layer.unit = "grey levels";
    layer.space = destination(forward).space;
    return layer;
  }

  [[nodiscard]] Layer raw_layer(const DirectionTrace& direction, bool forward) const {
    return mask_layer("Above the threshold", direction.raw_mask, destination(forward),
                      forward ? "raw_forward_mask" : "raw_backward_mask");
  }

  void add_tracks() {
    const MotionRound& first = trace_.rounds.front();
    Stage& tracks = log_.add("tracks", "Tracks", "Tracks",
                             "Corners of one frame followed into the other by pyramidal Lucas-Kanade.");
    tracks.ms = trace_.tracks_ms;
    tracks.figure("Forward", static_cast<double>(first.forward.tracks.size()));
    tracks.figure("Backward", static_cast<double>(first.backward.tracks.size()));
    std::vector<double> lengths;
    for (const Track& track : first.forward.tracks)
      lengths.push_back(std::hypot(static_cast<double>(track.to.x - track.from.x),
                                   static_cast<double>(track.to.y - track.from.y)));
    if (!lengths.empty()) tracks.figure("Forward: median length", median_of(lengths), "px", 2);
    add_sides(tracks, first, [&](const DirectionTrace& direction, bool forward) {
      const Layer& to = destination(forward);
      return StageSide{{}, {source(forward), to}, marked("Tracks", to, track_marks(direction, false))};
    });
  }

  /// What a round's homography is held against: the round's before, or no motion.
  void add_homography(const MotionRound& round, const MotionRound* last) {
    Stage& stage =
        add_round("homography", "Homography",
                  "RANSAC over the static tracks, then Levenberg-Marquardt on the inliers: eqs. (3), (4).");
    const cv::Size size = round.forward.compensated.size();
    for (const bool forward : {true, false}) {
      const DirectionTrace& direction = direction_of(round, forward);
      const std::string name = forward ? "Forward" : "Backward";
      stage.ms += direction.ms.homography;
      if (!direction.homography.valid) {
        stage.note += fmt::format("{}: no homography fits{}. ", name,
                                  direction.compensated.empty() ? "" : "; the last round's stands");
        continue;
      }
      stage.figure(name + ": inliers", direction.homography.ransac_inliers);
      stage.figure(name + ": RMS after RANSAC", direction.homography.ransac_error_px, "px", 3);
      stage.figure(name + ": RMS refined", direction.homography.refined_error_px, "px", 3);
      if (size.empty()) continue;
      stage.figure(name + ": furthest corner moves",
                   corner_shift_px(cv::Matx33d::eye(), direction.homography.matrix, size), "px", 2);
      if (last == nullptr) continue;
      const DirectionTrace& old = direction_of(*last, forward);
      if (!old.compensated.empty())
        stage.figure(name + ": corners differ from the round before",
                     corner_shift_px(old.homography.matrix, direction.homography.matrix, size), "px", 2);
    }
    add_sides(stage, round, [&](const DirectionTrace& direction, bool forward) {
      const Layer& to = destination(forward);
      Layer judged = marked("Inliers of the homography", to, track_marks(direction, true));
      judged.id = named("flow_tracks", forward);
      return StageSide{{}, {marked("Static tracks", to, track_marks(direction, false, true))}, judged};
    });
  }

  void add_warp(const MotionRound& round, const MotionRound* last) {
    add_homography(round, last);
    Stage& compensation = add_round("compensation", "Compensation",
                                    "Warps each frame into the other's camera by its homography.");
    compensation.ms = round.forward.ms.compensation + round.backward.ms.compensation;
    compensation.figure("Forward: pixels with data", percent_set(round.forward.valid), "%", 2);
    compensation.figure("Backward: pixels with data", percent_set(round.backward.valid), "%", 2);
    for (const bool forward : {true, false})
      if (const double exposure = direction_of(round, forward).exposure; exposure != 1.0)
        compensation.figure(forward ? "Forward: made brighter by" : "Backward: made brighter by",
                            100.0 * (exposure - 1.0), "%", 1);
    add_sides(compensation, round, [&](const DirectionTrace& direction, bool forward) {
      return StageSide{{}, {source(forward)}, compensated_layer(direction, forward)};
    });

    Stage& difference = add_round("difference", "Difference",
                                  "What differs between a frame and the compensated one: eq. (1).");
    difference.ms = round.forward.ms.difference + round.backward.ms.difference;
    for (const bool forward : {true, false}) {
      const DirectionTrace& direction = direction_of(round, forward);
      if (!direction.difference.empty())
        difference.figure(forward ? "Forward: mean" : "Backward: mean",
                          cv::mean(direction.difference, direction.valid)[0], "grey levels", 2);
    }
    add_sides(difference, round, [&](const DirectionTrace& direction, bool forward) {
      return StageSide{{},
                       {destination(forward), compensated_layer(direction, forward)},
                       difference_layer(direction, forward)};
    });
  }

  void add_masks(const MotionRound& round, bool last_round) {
    Stage& threshold =
        add_round("threshold", "Threshold", "Binarises the difference at Otsu's threshold: eq. (2).");
    threshold.ms = round.forward.ms.threshold + round.backward.ms.threshold;
    threshold.figure("Forward: threshold", round.forward.threshold, "grey levels");
    threshold.figure("Backward: threshold", round.backward.threshold, "grey levels");
    threshold.figure("Forward", percent_set(round.forward.raw_mask), "%", 2);
    threshold.figure("Backward", percent_set(round.backward.raw_mask), "%", 2);
    add_sides(threshold, round, [&](const DirectionTrace& direction, bool forward) {
      return StageSide{{}, {difference_layer(direction, forward)}, raw_layer(direction, forward)};
    });

    Stage& cleaned =
        add_round("clean_up", "Clean-up", "Erodes, dilates, and takes what has no data for static.");
    cleaned.ms = round.forward.ms.cleanup + round.backward.ms.cleanup;
    cleaned.figure("Forward", percent_set(round.forward.mask), "%", 2);
    cleaned.figure("Backward", percent_set(round.backward.mask), "%", 2);
    cleaned.overview = last_round;
    add_sides(cleaned, round, [&](const DirectionTrace& direction, bool forward) {
      return StageSide{{},
                       {raw_layer(direction, forward)},
                       mask_layer("Cleaned mask", direction.mask, destination(forward),
                                  forward ? "forward_mask" : "backward_mask")};
    });
    add_union(round, last_round);
    add_removal(round, last_round);
  }

  void add_union(const MotionRound& round, bool last_round) {
    Stage& united = add_round("union", "Union and regions",
                              "The backward mask warped into the target, united with the forward one.");
    united.ms = round.union_ms;
    united.overview = last_round;
    united.figure("Mask", 100.0 * round.mask_share, "%", 2);
    const std::size_t regions = round.mask.empty() ? 0 : find_regions(round.mask).regions.size();
    united.figure("Regions", static_cast<double>(regions));
    united.figure("Forward alone", percent_set(round.forward.mask), "%", 2);
    united.figure("Backward, warped", percent_set(round.backward_mask_in_target), "%", 2);
    const Layer warped =
        mask_layer("Backward mask, warped", round.backward_mask_in_target, target_, "warped_backward_mask");
    united.add_side({mask_layer("Forward mask", round.forward.mask, target_), warped},
                    mask_layer("Union", round.mask, target_, "union_mask"));
  }

  /// Tracks a round's mask takes out, and those it leaves.
  void add_removal(const MotionRound& round, bool last_round) {
    Stage& removal = add_round("track_removal", "Removal of tracks",
                               "Tracks in the mask do not enter the next round's homography.");
    removal.ms = round.removal_ms;
    removal.figure("Tracks that change sides", round.changed_tracks);
    removal.figure("Forward: tracks before", static_cast<double>(round.forward.tracks.size()) -
                                                 count_tracks(round.forward, &Track::removed));
    if (last_round)
      removal.note = round.changed_tracks == 0 ? "Nothing changes any more: this was the last round."
                                               : "This was the last round.";
    add_sides(removal, round, [&](const DirectionTrace& direction, bool forward) {
      std::vector<Mark> marks;
      for (const Track& track : direction.tracks)
        marks.push_back(
            {track.to, track.from,
             is_set(round.mask, forward ? track.to : track.from) ? MarkKind::kRemoved : MarkKind::kKept});
      return StageSide{{},
                       {mask_layer("Union", round.mask, target_)},
                       marked("Tracks left, and removed", destination(forward), std::move(marks))};
    });
  }

  const PaperTrace& trace_;
  StageLog& log_;
  Layer target_, reference_;
  int round_ = -1;
};

/// Which mask, region and round hold a target pixel, and by how much it differs.
std::vector<std::string> explain_pixel(const PaperTrace& trace, const cv::Point2f& pixel) {
  const MotionRound& last = trace.rounds.back();
  if (!is_set(last.mask, pixel)) return {};
  std::size_t since = trace.rounds.size() - 1;
  while (since > 0 && is_set(trace.rounds[since - 1].mask, pixel)) --since;
  const bool forward = is_set(last.forward.mask, pixel),
             backward = is_set(last.backward_mask_in_target, pixel);
  const LabelledRegions found = find_regions(last.mask);
  const int label = found.labels.at<int>(cvRound(pixel.y), cvRound(pixel.x));
  std::vector<std::string> sentences{
      fmt::format("The {} hold{} it: region {}, {} px, in the union since round {} of {}.",
                  forward && backward ? "forward and the backward mask"
                  : forward           ? "forward mask alone"
                                      : "backward mask alone",
                  forward && backward ? "" : "s", label,
                  found.regions[static_cast<std::size_t>(label - 1)].area, since + 1, trace.rounds.size())};
  bool above = is_set(last.forward.raw_mask, pixel);
  if (!last.backward.raw_mask.empty()) {
    const cv::Point2d there = carry(last.backward.homography.matrix, pixel);
    above = above || is_set(last.backward.raw_mask, cv::Point2f(there));
  }
  if (!above)
    sentences.emplace_back("It differs less than the threshold itself: dilation spread the mask to it.");
  return sentences;
}

}  // namespace

StageLog describe_paper(const Frame& frame, const PaperMotionTrace* trace) {
  StageLog log;
  if (trace == nullptr) return log;
  log.note = trace->pair.note;
  log.reference = trace->reference;
  log.reference_gray = trace->reference_gray;
  if (trace->pair.rounds.empty()) return log;
  PaperStages(frame, *trace, log).add_all();
  const MotionRound& last = trace->pair.rounds.back();
  if (!last.forward.compensated.empty()) log.forward = last.forward.homography.matrix;
  if (!last.backward.compensated.empty()) log.backward = last.backward.homography.matrix;
  log.explain = [pair = trace->pair](const cv::Point2f& pixel, bool) { return explain_pixel(pair, pixel); };
  return log;
}

}  // namespace stillpoint
