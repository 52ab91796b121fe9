// What `ptam` shows of a frame: small images, patches searched and found, their weights, keyframe and
// adjustment.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/odometry/ptam/ptam_tracker.hpp"

namespace stillpoint {
namespace {

constexpr std::array<const char*, PtamConfig::kLevels> kLevelNames = {"full size", "half", "quarter",
                                                                      "eighth"};

cv::Mat enlarged_small(const cv::Mat& small, const cv::Size& size, const Rectifier& rectifier) {
  cv::Mat whole;
  cv::resize(small + 128.0, whole, size, 0, 0, cv::INTER_NEAREST);
  return rectifier.to_image(whole);
}

}  // namespace

std::vector<Stage> PtamTrace::describe(const Frame& frame) const {
  StageLog log;
  const cv::Size size = frame.gray.size();
  const Layer now = photo_layer(fmt::format("Frame {}", frame.index), frame.gray);
  const auto at = [&](const Eigen::Vector2d& pixel) {
    return rectifier.to_image(cv::Point2f(static_cast<float>(pixel.x()), static_cast<float>(pixel.y())));
  };
  if (!begins) {
    Stage& start =
        log.add("ptam_prediction", kOdometryGroup, "Prediction",
                "A velocity that decays, its turn by laying the last small blurred image on this one.");
    start.timed = false;
    start.figure("Turn", turn_deg, "°", 2).figure("Speed", 100.0 * speed, "% of the depth", 2);
    start.note =
        relocalised ? "Tracking was lost: it begins from the keyframe whose small image is most alike." : "";
    if (!small_now.empty() && !small_before.empty())
      start.add_side({photo_layer("Small image before", enlarged_small(small_before, size, rectifier))},
                     photo_layer("Small image", enlarged_small(small_now, size, rectifier)));

    Stage& search =
        log.add("ptam_search", kOdometryGroup, "Patch search",
                "Looks for each point's patch, warped from its keyframe, at the corners about where it is "
                "expected; on the two top levels first when the camera goes fast.");
    search.timed = false;
    search.overview = true;
    int removed = 0;
    for (const PtamSeen& one : seen) removed += one.removed ? 1 : 0;
    search.figure("In view", static_cast<double>(seen.size())).figure("Removed by the mask", removed);
    for (std::size_t level = 0; level < searched.size(); ++level) {
      search.figure(fmt::format("Searched, {}", kLevelNames[level]), searched[level]);
      search.figure(fmt::format("Found, {}", kLevelNames[level]), found[level]);
    }
    search.note = coarse ? "A coarse search came first." : "";
    std::vector<Mark> marks;
    for (const PtamSeen& one : seen) {
      if (one.removed)
        marks.push_back({at(one.expected), std::nullopt, MarkKind::kRemoved});
      else if (one.found)
        marks.push_back(
            {at(one.found_at), at(one.expected), one.weight > 0.0 ? MarkKind::kInlier : MarkKind::kOutlier});
      else if (one.searched)
        marks.push_back({at(one.expected), std::nullopt, MarkKind::kUnmatched});
    }
    search.add_side({now}, marked("Expected and found", now, std::move(marks)));

    Stage& solve =
        log.add("ptam_pose", kOdometryGroup, "Pose",
                "Ten steps on the reprojection error, each weighed by Tukey's function, whose bound is the "
                "errors' own at first.");
    solve.timed = false;
    solve.overview = true;
    solve.figure("Tukey's bound", pose.bound_px, "px", 2).figure("Reprojection RMS", rms_px, "px", 3);
    solve.figure("Steps", pose.iterations);
    solve.note = quality == PtamQuality::kGood    ? "Quality is good."
                 : quality == PtamQuality::kDodgy ? "Quality is dodgy: no keyframe is made of it."
                                                  : "Quality is bad.";
    cv::Mat weights(size, CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
    for (const PtamSeen& one : seen) {
      if (!one.found) continue;
      const int half = 2 + one.level;
      const cv::Point2f middle = at(one.found_at);
      const cv::Rect square(cvRound(middle.x) - half, cvRound(middle.y) - half, 2 * half + 1, 2 * half + 1);
      weights(square & cv::Rect({0, 0}, size))
          .setTo(static_cast<float>(std::max(1e-3, one.weight * one.static_weight)));
    }
    Layer layer = length_layer("Weights", weights, "", FrameSpace::kTarget);
    layer.range = 1.0;
    layer.id = "ptam_weight";
    solve.add_side({now}, layer);
  }

  if (decided) {
    Stage& choice =
        log.add("ptam_keyframe", kOdometryGroup, "Keyframe?",
                "A keyframe when quality is good, the last one is long enough ago, and the nearest is far "
                "enough off for the scene's depth.");
    choice.timed = false;
    choice.figure("Distance over depth", keyframe_distance, "", 4).figure("Needed", keyframe_limit, "", 4);
    choice.figure("Frames since", frames_since).figure("Dropped points", dropped);
    choice.note = keyframe ? "This frame is a keyframe." : "This frame is no keyframe.";
  }
  if (!keyframe) return log.stages;

  Stage& points =
      log.add("ptam_points", kOdometryGroup, "New points",
              "Maximal corners that score well and lie off points there are, with the depth sensed there.");
  points.timed = false;
  points.overview = true;
  for (std::size_t level = 0; level < made.size(); ++level)
    points.figure(fmt::format("Made, {}", kLevelNames[level]), made[level]);
  std::vector<Mark> marks;
  for (const cv::Point2f& one : made_at) marks.push_back({one, std::nullopt, MarkKind::kKept});
  points.add_side({now}, marked("New points", now, std::move(marks)));

  if (!bundle) return log.stages;
  Stage& adjust =
      log.add("ptam_bundle", kOdometryGroup, "Bundle adjustment",
              "The keyframe and those nearest it, with their points, by reprojection error and Tukey's "
              "weights.");
  adjust.timed = false;
  int outliers = 0, free = 0;
  for (const auto& one : bundle->measurements) outliers += one.outlier ? 1 : 0;
  for (const auto& view : bundle->views) free += view.fixed ? 0 : 1;
  adjust.figure("Keyframes moved", free).figure("Held", static_cast<double>(bundle->views.size()) - free);
  adjust.figure("Points", static_cast<double>(bundle->points.size()));
  adjust.figure("Measurements", static_cast<double>(bundle->measurements.size()))
      .figure("Outliers", outliers);
  adjust.figure("RMS before", bundle->rms_before_px, "px", 3)
      .figure("RMS after", bundle->rms_after_px, "px", 3);
  adjust.figure("Steps", bundle->iterations);
  return log.stages;
}

}  // namespace stillpoint
