// What `bamvo` shows of a frame: its background model, residuals and weights, as used.
#include <fmt/format.h>

#include <limits>
#include <opencv2/imgproc.hpp>

#include "core/odometry/bamvo/bamvo_tracker.hpp"

namespace stillpoint {
namespace {

/// A rectified image of any size at full size, in the camera's own pixels.
cv::Mat shown(const cv::Mat& values, const cv::Size& size, const Rectifier& rectifier) {
  cv::Mat numbers, whole;
  values.convertTo(numbers, CV_32F);
  cv::resize(numbers, whole, size, 0, 0, cv::INTER_NEAREST);
  return rectifier.to_image(whole);
}

cv::Mat nan_where(const cv::Mat& values, const cv::Mat& where) {
  cv::Mat marked = values.clone();
  marked.setTo(std::numeric_limits<float>::quiet_NaN(), where);
  return marked;
}

/// A layer of the frame before, which is no part of the pair that the motion method compares.
Layer of_before(Layer layer, std::string id) {
  layer.elsewhere = true;
  layer.id = std::move(id);
  return layer;
}

}  // namespace

std::vector<Stage> BamvoTrace::describe(const Frame& frame) const {
  StageLog log;
  const cv::Size size = frame.gray.size();
  const Layer before =
      of_before(photo_layer(fmt::format("Frame {}", reference), gray, FrameSpace::kReference), {});
  const auto length = [&](std::string name, const cv::Mat& values, std::string unit, std::string id) {
    return of_before(length_layer(std::move(name), shown(values, size, rectifier), std::move(unit),
                                  FrameSpace::kReference),
                     std::move(id));
  };

  Stage& change = log.add("bamvo_change", kOdometryGroup, "Depth change",
                          "Warps the depth images before the last frame into it; the median of how far they "
                          "differ from its depth.");
  change.timed = false;
  Layer median = length("Median change", model.median_m, "m", "bamvo_change");
  median.range = 0.1;
  median.limit = foreground_change_m;
  change.figure("Depth images warped", past_depths - 1);
  change.figure("Pixels compared", percent_set(model.compared), "%", 1);
  if (past_depths < 2) change.note = "There is no earlier depth to compare with, so every pixel weighs 1.";
  change.add_side({before}, median);
  change.add_side({before}, length("Images compared", model.compared, "", "bamvo_compared"), "Count");

  Stage& density =
      log.add("bamvo_density", kOdometryGroup, "Background model",
              "A pixel's density B of its depth changes, a Gaussian kernel whose bandwidth is "
              "their median over 0.6744 √2; times its depth, smoothed, it is the pixel's weight.");
  density.timed = false;
  density.overview = true;
  Layer weights =
      length("B as it weighs", nan_where(model.weight, model.density == 0.0F), "", "bamvo_density");
  weights.range = 60.0;  // densities of a still room lie below; a change of 0 would hide all else
  density.add_side({median}, weights);

  Stage& label = log.add("bamvo_foreground", kOdometryGroup, "Foreground",
                         "Calls foreground what is less dense than a pixel of the limit's median change.");
  label.timed = false;
  label.overview = true;
  label.figure("Foreground", percent_set(model.foreground), "%", 2);
  const cv::Mat mask = shown(model.foreground, size, rectifier) > 0.0F;
  label.add_side({weights},
                 of_before(mask_layer("Foreground", mask, before, "bamvo_foreground"), "bamvo_foreground"));

  Stage& align =
      log.add("bamvo_alignment", kOdometryGroup, "Dense alignment",
              "Minimises the brightness residual of all pixels over the motion since the last frame, "
              "weighed by B and Student's t, at half size and full.");
  align.timed = false;
  align.overview = true;
  align.figure("Pixels that count", alignment.counted);
  align.figure("Steps", alignment.iterations);
  align.figure("Residual mean", 255.0 * alignment.mean, "grey levels", 2);
  align.figure("Residual sigma", 255.0 * alignment.sigma, "grey levels", 2);
  align.note = alignment.failure;
  const cv::Mat grey_levels = alignment.residual * 255.0;
  if (!alignment.residual.empty()) {
    align.add_side({before, photo_layer("Frame", frame.gray)},
                   of_before(signed_layer("Residual", shown(grey_levels, size, rectifier), 40.0,
                                          "grey levels", FrameSpace::kReference),
                             "bamvo_residual"));
    Layer whole = length("B and t together", alignment.weight, "", "bamvo_weight");
    whole.range = 100.0;
    align.add_side({weights}, whole, "Weight");
  }
  return log.stages;
}

}  // namespace stillpoint
