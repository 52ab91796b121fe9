#include "core/motion/gao2019/gao2019_stages.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace stillpoint {
namespace {

constexpr const char* kPose = "First pose";
constexpr const char* kModel = "Background model";
constexpr const char* kDetection = "Detection";
constexpr const char* kAgain = "Second pose";

class Stages {
 public:
  Stages(const Frame& frame, const Gao2019Trace& trace, const Gao2019Config& config, StageLog& log)
      : trace_(trace),
        config_(config),
        log_(log),
        frame_(photo_layer(fmt::format("Frame {}", frame.index), frame.gray)),
        filtered_(photo_layer(fmt::format("Frame {}, median", frame.index),
                              trace.step.after->frame->filtered.front().clone())) {}

  void add_all() {
    log_.small_factor = config_.block_px;
    if (trace_.last) add_first_pose();
    add_warp();
    add_update();
    add_detection();
    if (trace_.last) add_second_pose();
    log_.explain = [deviations = trace_.step.deviations, chosen = trace_.step.chosen, depths = here().depths,
                    moving = trace_.step.moving, cleaned = trace_.step.cleaned,
                    config = config_](const cv::Point2f& pixel, bool) {
      return explained(deviations, chosen, depths, moving, cleaned, config, pixel);
    };
  }

 private:
  [[nodiscard]] const Gao2019Frame& here() const { return *trace_.step.after->frame; }

  static void add_motion(Stage& stage, const std::string& of, const Pose& motion) {
    stage.figure("Travelled, " + of, 1000.0 * motion.translation().norm(), "mm", 1)
        .figure("Turned, " + of, degrees(motion), "°", 2);
  }
  static double degrees(const Pose& motion) { return rotation_angle(motion.linear()) * 180.0 / CV_PI; }

  static Layer mean_layer(std::string name, const cv::Mat& mean, std::string id = {}) {
    Layer layer = photo_layer(std::move(name), mean, FrameSpace::kSmall);
    layer.id = std::move(id);
    return layer;
  }
  static Layer sigma_layer(std::string name, const cv::Mat& variance, std::string id = {}) {
    cv::Mat sigma;
    cv::sqrt(variance, sigma);
    Layer layer = length_layer(std::move(name), sigma, "grey levels", FrameSpace::kSmall);
    layer.id = std::move(id);
    return layer;
  }
  [[nodiscard]] Layer age_layer(std::string name, const cv::Mat& age, std::string id = {}) const {
    Layer layer = length_layer(std::move(name), age, "frames", FrameSpace::kSmall);
    layer.range = config_.max_age;
    layer.id = std::move(id);
    return layer;
  }

  void add_first_pose() {
    const SparseAlignment& alignment = trace_.alignment;
    const Gao2019Frame& last = *trace_.last->frame;
    log_.reference = last.index;
    log_.reference_gray = last.pyramid.front();
    std::vector<Mark> marks;
    for (std::size_t i = 0; i < alignment.here.size(); ++i)
      if (const cv::Point2f& at = alignment.here[i]; std::isfinite(at.x))
        marks.push_back({at, trace_.last->points[i].pixel, MarkKind::kInlier});
    Layer patches = marked("Patches of the last frame, where they lie here", frame_, std::move(marks));
    patches.id = "flow_tracks";
    Stage& stage = log_.add(
        "alignment", kPose, "Sparse image alignment",
        "Finds the motion under which 4x4 patches of the last frame look alike here, coarse to fine.");
    stage.ms = trace_.ms_align;
    stage.overview = true;
    stage.note = alignment.note;
    stage.figure("Patches", alignment.patches)
        .figure("In view", alignment.in_view)
        .figure("Sigma of the residuals", alignment.sigma, "grey levels", 1)
        .figure("Steps", alignment.iterations);
    add_motion(stage, "first pose", trace_.first);
    if (trace_.by_odometry) add_motion(stage, "odometry", *trace_.by_odometry);
    stage.add_side({photo_layer("Last frame", last.pyramid.front(), FrameSpace::kReference)}, patches);
  }

  void add_warp() {
    const Gao2019Step& step = trace_.step;
    Stage& stage =
        log_.add("warp", kModel, "Warp",
                 "Carries the last model here: a block's middle goes by depth and the first pose, and by a "
                 "homography where there is no depth.");
    stage.ms = step.ms_grid + step.ms_warp;
    const double with_depth = percent_set(here().depths > 0.0F);
    stage.figure("Blocks with depth", with_depth, "%", 1);
    stage.figure("Brightness of the image", 100.0 * step.gain, "% of the model's", 1);
    if (trace_.last)
      stage.figure("Grid points followed", static_cast<double>(step.motion.tracks.size()))
          .figure("Inliers of the homography", step.motion.inliers);
    else
      stage.note = "The model begins with this frame.";
    Layer depths = length_layer("Median depth of the blocks", here().depths, "m", FrameSpace::kSmall);
    depths.id = "block_depth";
    stage.add_side({depths, age_layer("Age, warped", step.chosen[0].age, "warped_age")},
                   mean_layer("μ, warped", step.chosen[0].mean, "warped_mean"));
  }

  void add_update() {
    const Yi2013Model &before = trace_.step.chosen, &after = trace_.step.after->model;
    Stage& stage = log_.add("update", kModel, "Update",
                            "Averages each block into its Gaussian, by that Gaussian's age.");
    stage.ms = trace_.step.ms_update;
    stage.overview = true;
    stage.figure("Mean age", cv::mean(after[0].age)[0], "frames", 1);
    for (std::size_t mode = 0; mode < (config_.second_model ? 2U : 1U); ++mode) {
      const std::string name = mode == 0 ? "" : "Second ", id = mode == 0 ? "" : "_1";
      stage.add_side({mean_layer("μ, warped", before[mode].mean)},
                     mean_layer("μ", after[mode].mean, "mean" + id), name + "μ");
      stage.add_side({sigma_layer("σ, warped", before[mode].variance)},
                     sigma_layer("σ", after[mode].variance, "sigma" + id), name + "σ");
      stage.add_side({age_layer("Age, warped", before[mode].age)},
                     age_layer("Age", after[mode].age, "age" + id), name + "age");
    }
  }

  void add_detection() {
    const Gao2019Step& step = trace_.step;
    Layer off;
    off.name = "Largest squared deviation, by σ²";
    off.kind = LayerKind::kLength;
    off.image = step.deviations;
    off.range = 4.0 * config_.moving_limit;
    off.unit = "σ²";
    off.limit = config_.moving_limit;
    off.space = FrameSpace::kSmall;
    off.id = "deviation";
    Stage& test =
        log_.add("deviation", kDetection, "Change of variance",
                 "Measures each block's farthest pixel by its Gaussian's variance: max (I - μ)² / σ².");
    test.timed = false;
    test.overview = true;
    test.figure("Judged", percent_known(step.deviations), "%", 1);
    test.add_side({filtered_, mean_layer("μ", step.after->model[0].mean)}, off);

    const Layer ground = mean_layer("Blocks", here().blocks.mean);
    Stage& clean = log_.add("clean", kDetection, "Moving blocks",
                            "Takes out blocks that move alone, and fills those among many that move.");
    clean.timed = false;
    clean.figure("Beyond the limit", percent_set(step.moving), "%", 2)
        .figure("Cleaned", percent_set(step.cleaned), "%", 2);
    clean.add_side({mask_layer("Beyond the limit", step.moving, ground, "beyond")},
                   mask_layer("Moving blocks", step.cleaned, ground, "moving_blocks"));

    Stage& end =
        log_.add("mask", kDetection, "Mask", "Features and map points in moving blocks are dropped.");
    end.timed = false;
    end.overview = true;
    end.figure("Mask", percent_set(trace_.mask), "%", 2);
    end.add_side({mask_layer("Moving blocks", step.cleaned, ground)},
                 mask_layer("Mask", trace_.mask, frame_, "mask"));
  }

  void add_second_pose() {
    const FeaturePose& second = trace_.second;
    Stage& stage = log_.add(
        "second_pose", kAgain, "Second pose",
        "Solves the pose by the reprojection errors of what is left; the odometry does so once more.");
    stage.ms = trace_.ms_second;
    stage.figure("Features dropped", trace_.dropped)
        .figure("Features used", second.used)
        .figure("Inliers", second.inliers)
        .figure("Sigma of a reprojection error", second.sigma_px, "px", 2);
    if (second.found) {
      add_motion(stage, "second pose", trace_.second_motion);
      const Pose apart = trace_.second_motion * trace_.first.inverse();
      add_motion(stage, "from the first", apart);
    } else {
      stage.note = "Too few features agree: there is no second pose of its own.";
    }
    stage.add_side({frame_}, mask_layer("What is left out", trace_.mask, frame_));
  }

  static std::vector<std::string> explained(const cv::Mat& deviations, const Yi2013Model& chosen,
                                            const cv::Mat& depths, const cv::Mat& moving,
                                            const cv::Mat& cleaned, const Gao2019Config& config,
                                            const cv::Point2f& pixel) {
    const int x = cvRound(pixel.x) / config.block_px, y = cvRound(pixel.y) / config.block_px;
    if (pixel.x < 0.0F || pixel.y < 0.0F) return {};
    if (x >= cleaned.cols || y >= cleaned.rows)
      return {"It lies in a strip narrower than a block, where nothing is judged."};
    std::vector<std::string> sentences;
    const float deviation = deviations.at<float>(y, x);
    if (std::isfinite(deviation))
      sentences.push_back(fmt::format(
          "The farthest pixel of its block lies {:.1f} σ from the background's mean, {} the limit of "
          "{:.1f} σ; σ is {:.1f} grey levels, after {:.1f} frames.",
          std::sqrt(deviation), static_cast<double>(deviation) > config.moving_limit ? "beyond" : "within",
          std::sqrt(config.moving_limit), std::sqrt(chosen[0].variance.at<float>(y, x)),
          chosen[0].age.at<float>(y, x)));
    else
      sentences.push_back(
          fmt::format("The background of its block stands for {:.1f} frames: too few to judge by.",
                      chosen[0].age.at<float>(y, x)));
    const bool beyond = moving.at<std::uint8_t>(y, x) != 0, stays = cleaned.at<std::uint8_t>(y, x) != 0;
    if (beyond != stays)
      sentences.emplace_back(stays ? "It is dynamic because most blocks about it are."
                                   : "It is static because no block about it moves.");
    sentences.emplace_back(depths.at<float>(y, x) > 0.0F
                               ? "Depth and the first pose told where it was."
                               : "It has no depth: the homography told where it was.");
    return sentences;
  }

  const Gao2019Trace& trace_;
  const Gao2019Config& config_;
  StageLog& log_;
  Layer frame_, filtered_;
};

}  // namespace

StageLog describe_gao2019(const Frame& frame, const Gao2019Trace& trace, const Gao2019Config& config) {
  StageLog log;
  Stages(frame, trace, config, log).add_all();
  return log;
}

}  // namespace stillpoint
