// What `dso` shows of a frame: tracking's residuals, why it is a keyframe, its points and the window, as
// used.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/odometry/dso/dso_tracker.hpp"

namespace stillpoint {
namespace {

// Full colour, in grey levels: larger residuals are cut off, or nearly.
constexpr double kShownGreyLevels = 30.0;

cv::Mat nothing(const cv::Size& size) {
  return {size, CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN())};
}

/// A square about a point, so that it can be seen and pointed at.
void put(cv::Mat& values, const cv::Point2f& at, float value) {
  constexpr int kHalf = 2;  // px to each side of the point
  const cv::Rect square(cvRound(at.x) - kHalf, cvRound(at.y) - kHalf, 2 * kHalf + 1, 2 * kHalf + 1);
  values(square & cv::Rect({0, 0}, values.size())).setTo(value);
}

cv::Point2f place(double x, double y) { return {static_cast<float>(x), static_cast<float>(y)}; }

}  // namespace

std::vector<Stage> DsoTrace::describe(const Frame& frame) const {
  StageLog log;
  const cv::Size size = frame.gray.size();
  const Layer now = photo_layer(fmt::format("Frame {}", frame.index), frame.gray);

  Stage& track =
      log.add("dso_tracking", kOdometryGroup, "Direct tracking",
              "Lays the window's points where they look alike in this frame, over pose, gain and offset, "
              "coarse to fine.");
  track.timed = false;
  track.overview = true;
  if (tracking.tries == 0) {
    track.note = "The map begins with this frame.";
  } else {
    track.note = tracking.failure;
    track.figure("Frames back", frame.index - reference_frame);
    track.figure("Points in view", static_cast<double>(tracking.points.size()));
    track.figure("Within the cutoff", tracking.inliers);
    track.figure("Cutoff", tracking.cutoff, "grey levels");
    if (std::isfinite(tracking.rmse)) track.figure("Residual", tracking.rmse, "grey levels", 2);
    track.figure("Gain", std::exp(tracking.affine.a - reference_affine.a), "", 3);
    track.figure("Offset", tracking.affine.b - reference_affine.b, "grey levels", 2);
    track.figure("Starts tried", tracking.tries);
    track.figure("Steps", tracking.iterations);
    cv::Mat values = nothing(size);
    std::vector<Mark> marks;
    for (std::size_t i = 0; i < tracking.points.size(); ++i) {
      const cv::Point2f at = rectifier.to_image(place(tracking.points[i].u, tracking.points[i].v));
      const float residual = tracking.residuals[i];
      if (!std::isnan(residual)) put(values, at, residual);
      marks.push_back({at, std::nullopt,
                       std::isnan(residual)                                         ? MarkKind::kRemoved
                       : std::abs(static_cast<double>(residual)) <= tracking.cutoff ? MarkKind::kInlier
                                                                                    : MarkKind::kOutlier});
    }
    Layer residuals = signed_layer("Residual", values, kShownGreyLevels, "grey levels", FrameSpace::kTarget);
    residuals.id = "dso_residual";
    track.add_side({now}, residuals);
    track.add_side({now}, marked("Points by status", now, std::move(marks)), "Status");
  }

  if (decision) {
    Stage& choice =
        log.add("dso_keyframe", kOdometryGroup, "Keyframe?",
                "A keyframe when the flow by translation, the whole flow and the change of gain add up to "
                "more than 1, or the residual does.");
    choice.timed = false;
    choice.figure("Flow by translation", tracking.shift_px, "px", 1)
        .figure("Flow", tracking.flow_px, "px", 1);
    choice.figure("By translation", decision->shift, "", 2).figure("By flow", decision->flow, "", 2);
    choice.figure("By gain", decision->gain, "", 2).figure("Sum", decision->sum(), "", 2);
    choice.figure("Residual", decision->error, "", 2);
    choice.note = decision->keyframe ? "This frame is a keyframe." : "This frame is no keyframe.";
  }
  if (!keyframe) return log.stages;

  Stage& choose =
      log.add("dso_selection", kOdometryGroup, "Point selection",
              "Of each cell the steepest pixel above its block's median gradient + margin; of these, with "
              "depth and off other points, the new ones.");
  choose.timed = false;
  choose.overview = true;
  choose.figure("Candidates", static_cast<double>(keyframe->candidates.size()));
  choose.figure("Points made", static_cast<double>(keyframe->made.size()));
  choose.figure("Lost points", keyframe->lost_points);
  cv::Mat thresholds;
  cv::resize(keyframe->thresholds, thresholds, size, 0, 0, cv::INTER_NEAREST);
  Layer least =
      length_layer("Least gradient", rectifier.to_image(thresholds), "grey levels/px", FrameSpace::kTarget);
  least.id = "dso_threshold";
  std::vector<Mark> marks;
  for (const DsoCandidate& one : keyframe->candidates)
    marks.push_back({rectifier.to_image(place(one.x, one.y)), std::nullopt, MarkKind::kUnmatched});
  for (const DsoCandidate& one : keyframe->made)
    marks.push_back({rectifier.to_image(place(one.x, one.y)), std::nullopt, MarkKind::kKept});
  choose.add_side({least}, marked("Candidates and points made", now, std::move(marks)));
  choose.add_side({now}, least, "Threshold");

  Stage& solve =
      log.add("dso_window", kOdometryGroup, "Window",
              "Solves poses, gains, offsets of the window's keyframes and inverse depths of its points "
              "together, by the brightness of eight pixels a point.");
  solve.timed = false;
  const DsoWindow& window = keyframe->window;
  solve.figure("Keyframes", static_cast<double>(window.frames.size()));
  solve.figure("Points", static_cast<double>(window.points.size()));
  solve.figure("Residuals", keyframe->optimised.residuals).figure("Outliers", keyframe->optimised.outliers);
  solve.figure("RMS before", keyframe->optimised.rmse_before, "grey levels", 2);
  solve.figure("RMS after", keyframe->optimised.rmse_after, "grey levels", 2);
  solve.figure("Steps", keyframe->optimised.iterations);
  if (!keyframe->left.empty())
    solve.note = fmt::format("Frame {} left the window.", fmt::join(keyframe->left, ", "));
  for (std::size_t f = 0; f < window.frames.size(); ++f) {
    const DsoFrame& one = window.frames[f];
    cv::Mat values = nothing(size);
    for (const DsoResidual& residual : keyframe->residuals)
      if (residual.frame == static_cast<int>(f) && residual.good)
        put(values, rectifier.to_image(place(residual.x, residual.y)), residual.mean);
    Layer layer = signed_layer(fmt::format("Residual in frame {}", one.frame_index), values, kShownGreyLevels,
                               "grey levels", FrameSpace::kTarget);
    const bool newest = f + 1 == window.frames.size();
    layer.elsewhere = !newest;
    if (newest) layer.id = "dso_window_residual";
    solve.add_side({now}, layer,
                   fmt::format("Frame {}: gain {:.3f}, offset {:.1f}", one.frame_index,
                               std::exp(one.affine.a), one.affine.b));
  }
  return log.stages;
}

}  // namespace stillpoint
