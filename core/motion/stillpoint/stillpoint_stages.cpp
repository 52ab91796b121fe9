#include "core/motion/stillpoint/stillpoint_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/pixel_conventions.hpp"
#include "core/motion/regions.hpp"

namespace stillpoint {
namespace {

constexpr float kNoValue = std::numeric_limits<float>::quiet_NaN();
constexpr FrameSpace kSmall = FrameSpace::kSmall;

/// What is said of each pixel's superpixel; NaN where it is in none, or nothing is said of it.
template <typename OfSuperpixel>
cv::Mat superpixel_values(const StillpointTrace& trace, const OfSuperpixel& of_superpixel) {
  cv::Mat values(trace.labels.size(), CV_32FC1, cv::Scalar(kNoValue));
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x)
      if (const int label = trace.labels.at<int>(y, x); label >= 0)
        values.at<float>(y, x) = of_superpixel(static_cast<std::size_t>(label));
  return values;
}

class StillpointStages {
 public:
  StillpointStages(const Frame& frame, const StillpointMotionTrace& trace, const StillpointConfig& config,
                   StageLog& log)
      : trace_(trace.judged), view_(*trace.view), config_(config), log_(log) {
    target_ = photo_layer(fmt::format("Frame {}", frame.index), frame.gray);
    small_ = photo_layer(fmt::format("Frame {}, downsampled", frame.index), view_.gray, kSmall);
    depth_ = length_layer("Depth", view_.depth, "m", kSmall);
  }

  void add_all() {
    Stage& small = log_.add("downsampled", "Motion", "Downsampled frame",
                            "Grey, gradient and depth made smaller: where motion is judged.");
    small.timed = false;
    small.figure("Width", view_.gray.cols, "px").figure("Height", view_.gray.rows, "px");
    small.add_side({target_}, small_);
    for (std::size_t i = 0; i < trace_.references.size(); ++i) add_reference(i);
    add_prior();
    add_judgement();
  }

 private:
  [[nodiscard]] Layer depth_residual(const ReferenceEvidence& evidence) const {
    return signed_layer("Depth residual", evidence.depth_residual, 2.0 * config_.depth_sigmas, "σ", kSmall,
                        config_.depth_sigmas);
  }
  [[nodiscard]] Layer brightness_residual(const ReferenceEvidence& evidence) const {
    const double limit = config_.intensity_sigmas * evidence.intensity_sigma;
    return signed_layer("Brightness residual", evidence.intensity_residual, 2.0 * limit, "grey levels",
                        kSmall, limit);
  }
  [[nodiscard]] static Layer evidence_layer(const ReferenceEvidence& evidence) {
    return signed_layer("Evidence", evidence.log_odds, 2.0, "log-odds", kSmall, 0.0);
  }
  [[nodiscard]] Layer prior_layer() const {
    return signed_layer("Prior", trace_.prior, config_.max_log_odds, "log-odds", kSmall,
                        config_.moving_log_odds);
  }
  [[nodiscard]] Layer all_layer() const {
    return signed_layer("All evidence", trace_.log_odds, config_.max_log_odds, "log-odds", kSmall,
                        config_.moving_log_odds);
  }

  Stage& add_of_reference(std::size_t index, const char* id, const char* name, const char* what) {
    const std::string group = trace_.references.size() == 1 ? "Reference"
                              : index == 0                  ? "Near reference"
                                                            : "Far reference";
    Stage& stage = log_.add(id, group, name, what);
    stage.reference = static_cast<int>(index);
    stage.frames_back = trace_.references[index].reference.frames_back;
    stage.timed = false;
    return stage;
  }

  void add_reference(std::size_t index) {
    const ReferenceEvidence& evidence = trace_.references[index];
    const Pose& motion = evidence.reference.reference_from_current;
    Layer reference =
        photo_layer(fmt::format("The frame {} back", evidence.reference.frames_back),
                    evidence.reference.view ? evidence.reference.view->gray : cv::Mat(), kSmall);
    reference.elsewhere = true;
    const bool at_a_glance = index == 0;

    Stage& depth = add_of_reference(index, "depth_residual", "Depth residual",
                                    "Every pixel with depth warped into an earlier frame by the camera's "
                                    "motion: measured less expected depth there, in standard deviations.");
    depth.ms = evidence.ms;
    depth.timed = true;
    depth.overview = at_a_glance;
    depth.figure("Frames back", evidence.reference.frames_back)
        .figure("Camera moved", 1000.0 * motion.translation().norm(), "mm", 1)
        .figure("Camera turned", rotation_angle(motion.linear()) * 180.0 / CV_PI, "°", 2)
        .figure("Comparable", percent_known(evidence.depth_residual), "%", 1)
        .figure("Farther than the limit", percent_above(evidence.depth_residual, config_.depth_sigmas), "%",
                2)
        .figure("Nearer than the limit", percent_above(-evidence.depth_residual, config_.depth_sigmas), "%",
                2);
    depth.add_side({depth_, reference}, depth_residual(evidence));

    Stage& brightness = add_of_reference(index, "brightness_residual", "Brightness residual",
                                         "Where the surface is the same: what gradient and exposure do not "
                                         "explain.");
    brightness.overview = at_a_glance;
    const double limit = config_.intensity_sigmas * evidence.intensity_sigma;
    brightness.figure("Noise", evidence.intensity_sigma, "grey levels", 2)
        .figure("Limit", limit, "grey levels", 1)
        .figure("Above the limit", percent_above(evidence.intensity_residual, limit), "%", 2);
    brightness.add_side({small_, reference}, brightness_residual(evidence));

    Stage& said = add_of_reference(index, "evidence", "Evidence", "Both residuals as log-odds of motion.");
    said.figure("Speaks for motion", percent_above(evidence.log_odds, 0.0), "%", 2)
        .figure("Speaks for static", percent_above(-evidence.log_odds, 0.0), "%", 2);
    said.add_side({depth_residual(evidence), brightness_residual(evidence)}, evidence_layer(evidence));
    if (!evidence.motions.empty()) add_superpixel_shifts(index, evidence);
  }

  void add_superpixel_shifts(std::size_t index, const ReferenceEvidence& evidence) {
    constexpr float kLonger = 4.0F;  // drawn at twice that
    Stage& stage =
        add_of_reference(index, "superpixel_shifts", "Superpixel shifts",
                         "Shifts each superpixel to where it fits best, and takes off the camera's "
                         "motion that explains most: what is left tells slow objects.");
    stage.overview = true;
    std::vector<double> shifts;
    int moving = 0;
    Layer layer = signed_layer("Shifts, 8 times as long",
                               superpixel_values(trace_,
                                                 [&](std::size_t i) {
                                                   const float odds = evidence.motions[i].log_odds;
                                                   return odds != 0.0F ? odds : kNoValue;
                                                 }),
                               4.0, "log-odds", kSmall, 0.0);
    layer.words = {{MarkKind::kInlier, "speaks for static"}, {MarkKind::kOutlier, "speaks for motion"}};
    for (std::size_t i = 0; i < evidence.motions.size() && i < trace_.superpixels.size(); ++i) {
      const SuperpixelMotion& superpixel = evidence.motions[i];
      if (superpixel.log_odds == 0.0F) continue;
      shifts.push_back(cv::norm(superpixel.shift));
      moving += superpixel.log_odds > 0.0F ? 1 : 0;
      const cv::Point2f at = trace_.superpixels[i].centre, shift(superpixel.shift[0], superpixel.shift[1]);
      layer.marks.push_back(
          {at, at + kLonger * shift, superpixel.log_odds > 0.0F ? MarkKind::kOutlier : MarkKind::kInlier});
    }
    stage.add_side({prior_layer(), small_}, std::move(layer));
    stage.figure("Superpixels measured", static_cast<double>(shifts.size()));
    stage.figure("Of them speak for motion", moving);
    if (shifts.empty()) {
      stage.note = "No superpixel has texture enough to say how far it shifted.";
      return;
    }
    std::sort(shifts.begin(), shifts.end());
    stage.figure("Median shift", shifts[shifts.size() / 2], "downsampled px", 2);
    stage.figure("Largest shift", shifts.back(), "downsampled px", 2);
  }

  void add_prior() {
    Stage& prior =
        log_.add("prior", "Judgement", "Prior",
                 "What the frame before classified as dynamic, warped here by the camera's motion.");
    prior.ms = trace_.ms.prior;
    prior.overview = true;
    prior.figure("Dynamic by the prior", percent_above(trace_.prior, config_.moving_log_odds), "%", 2);
    prior.add_side({small_}, prior_layer());

    Stage& all =
        log_.add("all_evidence", "Judgement", "All evidence", "The prior and all evidence together.");
    all.timed = false;
    all.overview = true;
    if (!trace_.slow.empty())
      all.figure("Superpixels' shifts speak for motion", percent_above(trace_.slow, 0.0), "%", 2);
    all.figure("Dynamic with all evidence", percent_above(trace_.log_odds, config_.moving_log_odds), "%", 2);
    std::vector<Layer> inputs{prior_layer()};
    if (!trace_.slow.empty())
      inputs.push_back(signed_layer("Superpixels' shifts", trace_.slow, 2.0, "log-odds", kSmall, 0.0));
    for (const ReferenceEvidence& evidence : trace_.references) inputs.push_back(evidence_layer(evidence));
    all.add_side(std::move(inputs), all_layer());
  }

  void add_judgement() {
    const Layer judged =
        signed_layer("Superpixels",
                     superpixel_values(trace_, [&](std::size_t i) { return trace_.superpixels[i].log_odds; }),
                     config_.max_log_odds, "log-odds", kSmall, config_.moving_log_odds);
    Stage& stage =
        log_.add("superpixels", "Judgement", "Superpixels",
                 "Superpixels of one surface; each takes the mean of its pixels and agrees with its "
                 "neighbours.");
    stage.ms = trace_.ms.superpixels;
    stage.overview = true;
    stage.figure("Superpixels", static_cast<double>(trace_.superpixels.size()));
    stage.figure("Dynamic",
                 static_cast<double>(std::count_if(trace_.superpixels.begin(), trace_.superpixels.end(),
                                                   [](const Superpixel& s) { return s.moving; })));
    stage.add_side({all_layer()}, judged);

    Stage& mask =
        log_.add("mask", "Judgement", "Mask",
                 "Dynamic superpixels, small regions dropped, the outline fitted to the depth image.");
    mask.ms = trace_.ms.mask;
    mask.overview = true;
    mask.figure("Downsampled mask", percent_set(trace_.small_mask), "%", 2)
        .figure("Mask", 100.0 * trace_.mask_share, "%", 2)
        .figure("Regions", static_cast<double>(find_regions(trace_.mask).regions.size()));
    mask.note = trace_.note;
    mask.add_side({judged}, mask_layer("Mask", trace_.mask, target_, "mask"));
  }

  const StillpointTrace& trace_;
  const RgbdView& view_;
  const StillpointConfig& config_;
  StageLog& log_;
  Layer target_, small_, depth_;
};

std::vector<std::string> explain_pixel(const StillpointTrace& trace, const StillpointConfig& config,
                                       const cv::Point2f& pixel, bool removed) {
  if (!removed) return {};
  const cv::Point2f small = downsampled(pixel, static_cast<float>(config.factor));
  const int x = cvRound(small.x), y = cvRound(small.y);
  const cv::Rect image({0, 0}, trace.labels.size());
  const int label = image.contains({x, y}) ? trace.labels.at<int>(y, x) : -1;
  if (label < 0)
    return std::vector<std::string>(
        1, "It has no depth: what has none beside a dynamic superpixel goes with it.");
  const Superpixel& superpixel = trace.superpixels[static_cast<std::size_t>(label)];
  if (superpixel.moving)
    return {fmt::format(
        "Its superpixel, {} downsampled pixels at {:.2f} m, is dynamic: its own evidence is {:.2f}, {:.2f} "
        "with its neighbours'.",
        superpixel.pixels, static_cast<double>(superpixel.depth), static_cast<double>(superpixel.evidence),
        static_cast<double>(superpixel.log_odds))};
  return {
      fmt::format("Its own superpixel is not classified as dynamic: the mask reaches it from beside, by its "
                  "outline or its margin of {} px.",
                  config.margin_px)};
}

}  // namespace

StageLog describe_stillpoint(const Frame& frame, const StillpointMotionTrace& trace,
                             const StillpointConfig& config) {
  StageLog log;
  log.note = trace.judged.note;
  log.small_factor = trace.view->factor;
  if (trace.judged.log_odds.empty()) return log;
  StillpointStages(frame, trace, config, log).add_all();
  log.explain = [judged = trace.judged, config](const cv::Point2f& pixel, bool removed) {
    return explain_pixel(judged, config, pixel, removed);
  };
  return log;
}

}  // namespace stillpoint
