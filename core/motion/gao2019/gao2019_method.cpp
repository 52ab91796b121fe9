// Method `gao2019`: a first pose by sparse image alignment warps a background model of blocks, a Gaussian and
// a candidate each, by depth; features in blocks whose variance changes are dropped, and the pose is solved
// again.
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/motion/gao2019/gao2019_stages.hpp"
#include "core/motion/methods.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

struct Preparation final : MotionPreparation {
  std::shared_ptr<const Gao2019Frame> frame;  // null where the image is smaller than a block
};

class Gao2019Method final : public MotionMethod {
 public:
  Gao2019Method(const Camera& camera, const Gao2019Config& config)
      : camera_(camera),
        config_(config),
        model_config_(config.model()),
        rays_(camera, {camera.width, camera.height}, config.block_px) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<Gao2019Method>(*this);
  }

  [[nodiscard]] std::shared_ptr<const MotionPreparation> prepare(
      const Frame& frame, std::span<const std::shared_ptr<const MotionPreparation>>, int) const override {
    auto preparation = std::make_shared<Preparation>();
    const cv::Size size = frame.gray.size();
    if (std::min(size.width, size.height) < std::max(config_.block_px, 2 * kPatchSide)) return preparation;
    auto ready = std::make_shared<Gao2019Frame>();
    ready->index = frame.index;
    ready->pyramid = alignment_pyramid(frame.gray, config_.coarsest_level);
    ready->corners = corner_points(frame.gray, frame.depth, camera_for(size), config_);
    cv::Mat filtered;
    cv::medianBlur(frame.gray, filtered, 2 * config_.median_radius_px + 1);
    ready->filtered = yi2013_pyramid(filtered, model_config_);
    ready->blocks = yi2013_blocks(filtered, config_.block_px);
    ready->depths = block_depths(frame.depth, ready->blocks.mean.size(), config_.block_px);
    const bool usual = size == cv::Size(camera_.width, camera_.height);
    ready->rays = usual ? rays_ : PixelRays(camera_, size, config_.block_px);
    preparation->frame = std::move(ready);
    return preparation;
  }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    const auto& ready = static_cast<const Preparation&>(*input.prepared).frame;
    MotionResult result;
    if (!ready) {
      result.note = "the image is smaller than a block of the background model";
      return result;
    }
    auto trace = std::make_shared<Gao2019Trace>();
    trace->last = comparable(*ready);
    const Camera camera = camera_for(input.frame.gray.size());
    Stopwatch watch;
    if (trace->last) find_first_pose(input, *ready, camera, *trace);
    trace->ms_align = watch.lap();
    trace->step = step(ready, trace->last, trace->first, camera);
    trace->mask = mask_of_blocks(trace->step.cleaned, config_.block_px, input.frame.gray.size());
    (void)watch.lap();
    if (trace->last) find_second_pose(input, camera, *trace);
    trace->ms_second = watch.lap();

    result.mask = trace->mask;
    result.mask_share = percent_set(trace->mask) / 100.0;
    if (trace->last)
      result.figures = {static_cast<double>(trace->alignment.in_view), trace->alignment.sigma,
                        percent_known(trace->step.deviations) / 100.0, static_cast<double>(trace->dropped)};
    if (!trace->last)
      result.note = "the background model begins with this frame";
    else if (!trace->aligned && config_.first_pose == "alignment")
      result.note =
          trace->alignment.note + (trace->by_odometry ? ": the odometry's first pose stands in"
                                                      : ": the camera is taken to be static, for the "
                                                        "last frame has no pose");
    result.trace = std::move(trace);
    return result;
  }

  void commit(const MotionInput& input, const MotionResult& result, const MotionOutcome& outcome) override {
    const auto& ready = static_cast<const Preparation&>(*input.prepared).frame;
    const std::optional<Pose> before = pose_;
    pose_.reset();
    if (outcome.estimated) pose_ = outcome.camera_from_world;
    motion_ = before && pose_ ? std::optional(*pose_ * before->inverse()) : std::nullopt;
    if (result.trace) {
      state_ = static_cast<const Gao2019Trace&>(*result.trace).step.after;
    } else if (ready) {
      // A frame that was not judged: the final pose warps the model, and where there is none it begins anew.
      const auto last = motion_ ? comparable(*ready) : nullptr;
      state_ =
          step(ready, last, motion_.value_or(Pose::Identity()), camera_for(input.frame.gray.size())).after;
    } else {
      state_.reset();
    }
  }

  /// Gaussians forget what lies farther back than their oldest age, but for a small share.
  [[nodiscard]] int frames_back() const override { return static_cast<int>(std::ceil(config_.max_age)); }

  [[nodiscard]] bool settled() const override {
    return state_ && static_cast<double>(state_->frames) > config_.settled_age;
  }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    return config.of<Gao2019Config>() == config_ ? clone() : nullptr;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log;
    if (result.trace) log = describe_gao2019(frame, static_cast<const Gao2019Trace&>(*result.trace), config_);
    log.note = result.note;
    return log;
  }

 private:
  [[nodiscard]] Camera camera_for(const cv::Size& size) const {
    return camera_.scaled_to(size.width, size.height);
  }

  /// The last frame's state, where this frame can be compared with it.
  [[nodiscard]] std::shared_ptr<const Gao2019State> comparable(const Gao2019Frame& here) const {
    return state_ && state_->frame->filtered.front().size() == here.filtered.front().size() ? state_
                                                                                            : nullptr;
  }

  /// (a) of the paper.
  void find_first_pose(const MotionInput& input, const Gao2019Frame& here, const Camera& camera,
                       Gao2019Trace& trace) const {
    if (pose_) trace.by_odometry = *input.camera_from_world * pose_->inverse();
    trace.first = trace.by_odometry.value_or(Pose::Identity());
    // Constant velocity is where alignment begins; from where the odometry ends it would take its outcome
    // over.
    trace.alignment = align_sparsely(trace.last->frame->pyramid, trace.last->points, here.pyramid,
                                     motion_.value_or(Pose::Identity()), camera, config_);
    trace.aligned = trace.alignment.found && config_.first_pose == "alignment";
    if (trace.aligned) trace.first = trace.alignment.here_from_last;
  }

  /// (b) and (c): the model in this frame's pixels, and with this frame in it.
  [[nodiscard]] Gao2019Step step(const std::shared_ptr<const Gao2019Frame>& here,
                                 const std::shared_ptr<const Gao2019State>& last, const Pose& here_from_last,
                                 const Camera& camera) const {
    Gao2019Step step;
    Stopwatch watch;
    Yi2013Places places;
    if (last) {
      step.motion = yi2013_motion(here->filtered, last->frame->filtered, model_config_);
      places = yi2013_places(here->blocks.mean.size(), step.motion.last_from_here, config_.block_px);
      step.ms_grid = watch.lap();
      places = places_by_depth(here->depths, here->rays, here_from_last.inverse(), camera, config_.block_px,
                               places);
    }
    step.chosen = yi2013_warped(last ? last->model : Yi2013Model(), places, here->blocks, model_config_);
    if (config_.follow_exposure) {
      step.gain = exposure_gain(here->blocks, step.chosen, config_.settled_age);
      brighten(step.chosen, step.gain);
    }
    if (config_.second_model)
      step.matches = yi2013_choose(step.chosen, here->blocks, model_config_);
    else
      step.matches = cv::Mat(here->blocks.mean.size(), CV_8UC1, cv::Scalar(kMatchApparent));
    step.ms_warp = watch.lap();
    auto after = std::make_shared<Gao2019State>();
    after->frame = here;
    after->model = yi2013_updated(step.chosen, step.matches, here->blocks, model_config_);
    after->frames = last ? last->frames + 1 : 1;
    step.deviations = block_deviations(here->blocks, step.chosen, after->model, config_.settled_age);
    step.moving = step.deviations > config_.moving_limit;  // NaN is not
    step.cleaned = clean_blocks(step.moving, config_.drop_isolated, config_.fill_neighbours);
    for (const AlignmentPoint& corner : here->corners)
      if (!in_moving_block(step.cleaned, corner.pixel)) after->points.push_back(corner);
    step.after = std::move(after);
    step.ms_update = watch.lap();
    return step;
  }

  [[nodiscard]] bool in_moving_block(const cv::Mat& blocks, const cv::Point2f& pixel) const {
    const int x = cvRound(pixel.x) / config_.block_px, y = cvRound(pixel.y) / config_.block_px;
    return x >= 0 && y >= 0 && x < blocks.cols && y < blocks.rows && blocks.at<std::uint8_t>(y, x) != 0;
  }

  /// (d) and (e), as the odometry will do it.
  void find_second_pose(const MotionInput& input, const Camera& camera, Gao2019Trace& trace) const {
    std::vector<std::uint8_t> left_out(input.features.size(), 0);
    for (std::size_t i = 0; i < left_out.size(); ++i) {
      if (!in_moving_block(trace.step.cleaned, input.features[i].pixel)) continue;
      left_out[i] = 1;
      if (input.features[i].map_point >= 0) ++trace.dropped;
    }
    trace.second = pose_of_features(input.features, left_out, *input.camera_from_world, camera);
    if (pose_) trace.second_motion = trace.second.camera_from_world * pose_->inverse();
    keep_points(input, camera, trace.second.is_inlier, *trace.step.after);
  }

  /// The local map's points that are left, as this frame sees them, are what the next one is aligned with.
  void keep_points(const MotionInput& input, const Camera& camera, const std::vector<std::uint8_t>& is_inlier,
                   Gao2019State& after) const {
    std::vector<cv::Point2f> pixels;
    std::vector<double> depths;
    for (std::size_t i = 0; i < is_inlier.size(); ++i) {
      const MotionFeature& feature = input.features[i];
      if (is_inlier[i] == 0 || feature.depth <= 0.0F) continue;
      pixels.push_back(feature.pixel);
      depths.push_back(static_cast<double>(feature.depth));
    }
    if (static_cast<int>(pixels.size()) < 2 * config_.min_patches) return;  // corners do
    const std::vector<cv::Point2f> straight = camera.undistort(pixels);
    after.points.clear();
    for (std::size_t i = 0; i < pixels.size(); ++i)
      after.points.push_back({pixels[i], camera.back_project({static_cast<double>(straight[i].x),
                                                              static_cast<double>(straight[i].y)},
                                                             depths[i])});
  }

  Camera camera_;
  Gao2019Config config_;
  Yi2013Config model_config_;
  PixelRays rays_;
  std::shared_ptr<const Gao2019State> state_;  // null before the first frame
  std::optional<Pose> pose_;                   // of the last frame, where it was measured
  std::optional<Pose> motion_;                 // last frame from the one before it
};

}  // namespace

MethodInfo gao2019_method() {
  MethodInfo info;
  info.name = "gao2019";
  info.title = "Gao et al. 2019";
  info.summary =
      "A background of blocks, a Gaussian and a candidate each, warped by a first pose and depth; moving is "
      "where variance grows.";
  info.citation =
      "Gao C., Zhang Y., Wang X., Deng Y., Jiang H.: Semi-direct RGB-D SLAM algorithm for dynamic indoor "
      "environments, "
      "Robot 41(3), 2019, doi 10.13973/j.cnki.robot.180362";
  // Without depth a homography warps the model, and the odometry's pose goes on by the map.
  info.needs.first_pose = info.needs.matches = info.needs.keeps_state = true;
  info.parameters = AnySection(Gao2019Config());
  info.figures = {{"gao2019_patches", FigureUnit::plain, "patches that image alignment sees in the frame", 0},
                  {"gao2019_sigma", FigureUnit::plain, "deviation of their residuals, grey levels", 2},
                  {"gao2019_judged", FigureUnit::share, "blocks whose Gaussian is old enough to judge", 4},
                  {"gao2019_dropped", FigureUnit::plain, "matched features in moving blocks", 0}};
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<Gao2019Method>(camera, config.of<Gao2019Config>());
  };
  return info;
}

}  // namespace stillpoint
