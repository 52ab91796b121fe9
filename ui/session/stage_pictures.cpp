#include "ui/session/stage_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/motion/stillpoint/reference_warp.hpp"

namespace stillpoint {
namespace {

const MotionRound* round_of(const FrameView& view, const StageInfo& stage) {
  if (stage.round < 0 || static_cast<std::size_t>(stage.round) >= view.motion.rounds.size())
    return stage.kind == StageKind::kTracks && !view.motion.rounds.empty() ? &view.motion.rounds.front()
                                                                           : nullptr;
  return &view.motion.rounds[static_cast<std::size_t>(stage.round)];
}

const ReferenceEvidence* evidence_of(const FrameView& view, const StageInfo& stage) {
  if (stage.reference < 0 || static_cast<std::size_t>(stage.reference) >= view.depth_motion.references.size())
    return nullptr;
  return &view.depth_motion.references[static_cast<std::size_t>(stage.reference)];
}

StagePicture photo(const std::string& heading, const cv::Mat& image, FrameSpace space) {
  return {heading, PictureLook::kPhoto, image, {}, 0.0, {}, space};
}

StagePicture target_photo(const FrameView& view) {
  return photo(fmt::format("Frame {}", view.frame.index), view.frame.gray, FrameSpace::kTarget);
}

StagePicture reference_photo(const FrameView& view) {
  return photo(fmt::format("Frame {}", view.reference.index), view.reference.gray, FrameSpace::kReference);
}

/// The frame a direction carries into, in whose camera its images are.
StagePicture destination(const FrameView& view, bool backward) {
  return backward ? reference_photo(view) : target_photo(view);
}

StagePicture source(const FrameView& view, bool backward) {
  return backward ? target_photo(view) : reference_photo(view);
}

StagePicture mask_over(const std::string& heading, const cv::Mat& mask, const StagePicture& ground) {
  return {heading, PictureLook::kMask, mask, ground.image, 0.0, {}, ground.space};
}

StagePicture signed_picture(const std::string& heading, const cv::Mat& values, double range,
                            const char* unit) {
  return {heading, PictureLook::kSigned, values, {}, range, unit, FrameSpace::kSmall};
}

StagePicture levels(const DirectionTrace& direction, bool backward) {
  return {"Difference",
          PictureLook::kLevels,
          direction.difference,
          {},
          std::clamp(3.0 * direction.threshold, 30.0, 255.0),
          "grey levels",
          backward ? FrameSpace::kReference : FrameSpace::kTarget};
}

std::vector<PictureDot> track_dots(const DirectionTrace& direction, bool judged, bool removed_only = false) {
  std::vector<PictureDot> dots;
  for (const Track& track : direction.tracks) {
    if (removed_only && track.removed) continue;
    const DotKind kind = !judged         ? DotKind::kKept
                         : track.removed ? DotKind::kRemoved
                         : track.inlier  ? DotKind::kInlier
                                         : DotKind::kOutlier;
    dots.push_back({track.to, track.from, kind});
  }
  return dots;
}

bool is_set(const cv::Mat& mask, const cv::Point2f& place) {
  const int x = cvRound(place.x), y = cvRound(place.y);
  return x >= 0 && y >= 0 && x < mask.cols && y < mask.rows && mask.at<std::uint8_t>(y, x) != 0;
}

/// Tracks a round's mask takes out, and those it leaves.
std::vector<PictureDot> removal_dots(const MotionRound& round, bool backward) {
  std::vector<PictureDot> dots;
  for (const Track& track : (backward ? round.backward : round.forward).tracks) {
    const cv::Point2f in_target = backward ? track.from : track.to;
    dots.push_back(
        {track.to, track.from, is_set(round.mask, in_target) ? DotKind::kRemoved : DotKind::kKept});
  }
  return dots;
}

std::vector<PictureDot> feature_dots(const FrameRecord& record, bool fates) {
  std::vector<PictureDot> dots;
  for (const FeatureRecord& feature : record.features) {
    const DotKind kind = feature.fate == FeatureFate::removed   ? DotKind::kRemoved
                         : !fates                               ? DotKind::kKept
                         : feature.fate == FeatureFate::inlier  ? DotKind::kInlier
                         : feature.fate == FeatureFate::outlier ? DotKind::kOutlier
                                                                : DotKind::kUnmatched;
    dots.push_back({feature.pixel, std::nullopt, kind});
  }
  return dots;
}

StagePicture dotted(std::string heading, StagePicture ground, std::vector<PictureDot> dots) {
  ground.heading = std::move(heading);
  ground.dots = std::move(dots);
  return ground;
}

StagePictures paper_pictures(const FrameView& view, const MotionRound& round, StageKind kind, bool backward) {
  const DirectionTrace& direction = backward ? round.backward : round.forward;
  const StagePicture to = destination(view, backward), from = source(view, backward);
  const StagePicture compensated =
      photo("Compensated", direction.compensated,
            backward ? FrameSpace::kCompensatedBackward : FrameSpace::kCompensatedForward);
  switch (kind) {
    case StageKind::kTracks:
      return {{from, to}, dotted("Tracks", to, track_dots(direction, false))};
    case StageKind::kHomography:
      return {{dotted("Static tracks", to, track_dots(direction, false, true))},
              dotted("Inliers of the homography", to, track_dots(direction, true))};
    case StageKind::kCompensation:
      return {{from}, compensated};
    case StageKind::kDifference:
      return {{to, compensated}, levels(direction, backward)};
    case StageKind::kThreshold:
      return {{levels(direction, backward)}, mask_over("Above the threshold", direction.raw_mask, to)};
    case StageKind::kCleanUp:
      return {{mask_over("Above the threshold", direction.raw_mask, to)},
              mask_over("Cleaned mask", direction.mask, to)};
    case StageKind::kUnion:
      return {{mask_over("Forward mask", round.forward.mask, target_photo(view)),
               mask_over("Backward mask, carried", round.backward_mask_in_target, target_photo(view))},
              mask_over("Union", round.mask, target_photo(view))};
    default:
      return {{mask_over("Union", round.mask, target_photo(view))},
              dotted("Tracks left, and taken out", to, removal_dots(round, backward))};
  }
}

/// What is said of each pixel's patch; NaN where it is in none, or nothing is said of it.
cv::Mat patch_values(const StillpointTrace& trace, const std::function<float(std::size_t)>& of_patch) {
  cv::Mat values(trace.labels.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x)
      if (const int label = trace.labels.at<int>(y, x); label >= 0)
        values.at<float>(y, x) = of_patch(static_cast<std::size_t>(label));
  return values;
}

cv::Mat segment_values(const StillpointTrace& trace) {
  return patch_values(trace, [&](std::size_t i) { return trace.segments[i].log_odds; });
}

/// What patches say by their shifts, which are drawn as lines several times as long.
StagePicture patch_shifts(const StillpointTrace& trace, const std::vector<PatchMotion>& patches) {
  constexpr float kLonger = 4.0F;  // drawn at twice that
  StagePicture picture = signed_picture("Shifts, 8 times as long",
                                        patch_values(trace,
                                                     [&](std::size_t i) {
                                                       return patches[i].log_odds != 0.0F
                                                                  ? patches[i].log_odds
                                                                  : std::numeric_limits<float>::quiet_NaN();
                                                     }),
                                        4.0, "log-odds");
  for (std::size_t i = 0; i < patches.size() && i < trace.segments.size(); ++i) {
    if (patches[i].log_odds == 0.0F) continue;
    const cv::Point2f at = trace.segments[i].centre;
    const cv::Point2f shift(patches[i].shift[0], patches[i].shift[1]);
    picture.dots.push_back(
        {at, at + kLonger * shift, patches[i].log_odds > 0.0F ? DotKind::kOutlier : DotKind::kInlier});
  }
  return picture;
}

StagePictures reference_pictures(const FrameView& view, const Camera& camera, const Config& config,
                                 const ReferenceEvidence& evidence, StageKind kind) {
  const StillpointTrace& trace = view.depth_motion;
  const StillpointConfig& limits = config.depth_motion;
  const StagePicture depth =
      signed_picture("Depth residual", evidence.depth_residual, 2.0 * limits.depth_sigmas, "σ");
  const StagePicture brightness =
      signed_picture("Brightness residual", evidence.intensity_residual,
                     2.0 * limits.intensity_sigmas * evidence.intensity_sigma, "grey levels");
  if (kind == StageKind::kEvidence)
    return {{depth, brightness}, signed_picture("Evidence", evidence.log_odds, 2.0, "log-odds")};
  const RgbdView small = make_rgbd_view(view.frame.gray, view.frame.depth, camera, limits.factor);
  const StagePicture here =
      photo(fmt::format("Frame {}, small", view.frame.index), small.gray, FrameSpace::kSmall);
  StagePicture there{"Depth", PictureLook::kLength, small.depth, {}, 0.0, "m", FrameSpace::kSmall};
  double farthest = 0.0;
  cv::minMaxLoc(small.depth, nullptr, &farthest);
  there.range = std::max(1.0, farthest);
  if (kind == StageKind::kDepthResidual) return {{there}, depth};
  if (kind == StageKind::kPatchShifts && trace.segments.size() == evidence.patches.size())
    return {{signed_picture("Remembered", trace.prior, limits.max_log_odds, "log-odds"), here},
            patch_shifts(trace, evidence.patches)};
  const StagePicture warped =
      photo("The reference, warped here",
            evidence.reference.view ? warp_reference(small, evidence.reference).gray : cv::Mat(),
            FrameSpace::kSmall);
  if (kind == StageKind::kBrightnessResidual) return {{here, warped}, brightness};
  StagePicture reference =
      photo("The reference, small", evidence.reference.view ? evidence.reference.view->gray : cv::Mat(),
            FrameSpace::kSmall);
  reference.elsewhere = true;
  return {{here, there, reference}, warped};
}

StagePictures stillpoint_pictures(const FrameView& view, const Camera& camera, const Config& config,
                                  const StageInfo& stage) {
  const StillpointTrace& trace = view.depth_motion;
  const double most = config.depth_motion.max_log_odds;
  if (const ReferenceEvidence* evidence = evidence_of(view, stage))
    return reference_pictures(view, camera, config, *evidence, stage.kind);
  const StagePicture all = signed_picture("All evidence", trace.log_odds, most, "log-odds");
  const StagePicture patches = signed_picture("Patches", segment_values(trace), most, "log-odds");
  const RgbdView small =
      make_rgbd_view(view.frame.gray, view.frame.depth, camera, config.depth_motion.factor);
  if (stage.kind == StageKind::kMemory) {
    StagePictures pictures{{signed_picture("Remembered", trace.prior, most, "log-odds")}, all};
    if (!trace.slow.empty())
      pictures.inputs.push_back(signed_picture("Patches' shifts", trace.slow, 2.0, "log-odds"));
    for (const ReferenceEvidence& evidence : trace.references)
      pictures.inputs.push_back(signed_picture("Evidence", evidence.log_odds, 2.0, "log-odds"));
    return pictures;
  }
  if (stage.kind == StageKind::kSegments) return {{all}, patches};
  if (stage.kind == StageKind::kMotionMask)
    return {{patches}, mask_over("Mask", trace.mask, target_photo(view))};
  return {{target_photo(view)}, photo("Small view", small.gray, FrameSpace::kSmall)};
}

/// Patches that were aligned directly, as squares of their residual.
StagePicture direct_picture(const FrameView& view, const DirectRecord& direct) {
  constexpr int kHalf = 4;  // px
  cv::Mat values(view.frame.gray.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
  if (direct.seen)
    for (const DirectPatch& patch : *direct.seen) {
      const cv::Point middle(cvRound(patch.pixel.x), cvRound(patch.pixel.y));
      const cv::Rect square(middle.x - kHalf, middle.y - kHalf, 2 * kHalf + 1, 2 * kHalf + 1);
      values(square & cv::Rect({0, 0}, values.size())).setTo(patch.residual);
    }
  return {"Patches by their residual",
          PictureLook::kSigned,
          values,
          {},
          std::max(10.0, std::ceil(2.0 * direct.rms_after)),
          "grey levels"};
}

StagePictures odometry_pictures(const FrameView& view, StageKind kind) {
  const StagePicture plain = target_photo(view);
  if (view.record == nullptr) return {{}, plain};
  const StagePicture found = dotted("Features", plain, feature_dots(*view.record, false));
  const StagePicture judged = dotted("Inliers and outliers", plain, feature_dots(*view.record, true));
  switch (kind) {
    case StageKind::kFeatures:
      return {{plain}, found};
    case StageKind::kTrueMask:
      return {{plain}, mask_over("True mask", view.mask, plain)};
    case StageKind::kFeatureRemoval:
      return {{view.mask.empty() ? plain : mask_over("Mask", view.mask, plain)},
              dotted("Kept and removed", plain, feature_dots(*view.record, false))};
    case StageKind::kDirectRefinement:
      return {{plain, judged}, direct_picture(view, view.record->direct)};
    case StageKind::kMatching:
      return {{found}, dotted("Matched, and not", plain, feature_dots(*view.record, true))};
    default:
      return {{found}, judged};
  }
}

}  // namespace

StagePictures stage_pictures(const FrameView& view, const Camera& camera, const Config& config,
                             const StageInfo& stage, bool backward) {
  if (const MotionRound* round = round_of(view, stage))
    return paper_pictures(view, *round, stage.kind, backward);
  if (of_colour(stage.kind)) return colour_pictures(view, config, stage);
  if (of_odometry(stage.kind) || stage.kind == StageKind::kTrueMask)
    return odometry_pictures(view, stage.kind);
  if (stage.kind == StageKind::kFirstPose)
    return {{},
            dotted("Features it is found from", target_photo(view),
                   view.record != nullptr ? feature_dots(*view.record, true) : std::vector<PictureDot>())};
  if (view.depth_motion.log_odds.empty()) return {{}, target_photo(view)};
  return stillpoint_pictures(view, camera, config, stage);
}

}  // namespace stillpoint
