// Method `alcantarilla2012`: dense flow and depth make a scene flow; what remains of it under the camera's
// motion is tested against its own covariance.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/motion/alcantarilla2012/alcantarilla2012_stages.hpp"
#include "core/motion/methods.hpp"
#include "core/motion/rgbd_view.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

struct Preparation final : MotionPreparation {
  std::shared_ptr<const FlowImages> images;
  std::shared_ptr<const FlowImages> last;  // the frame before, where there is one that can be compared with
  FlowPair flow;
  double ms = 0.0;

  [[nodiscard]] std::shared_ptr<const MotionPreparation> for_later() const override {
    auto kept = std::make_shared<Preparation>();
    kept->images = images;
    return kept;
  }
};

const Preparation& prepared(const MotionInput& input) {
  return static_cast<const Preparation&>(*input.prepared);
}

class Alcantarilla2012Method final : public MotionMethod {
 public:
  Alcantarilla2012Method(const Camera& camera, const Alcantarilla2012Config& config)
      : camera_(camera),
        config_(config.for_camera(camera)),
        rays_(camera, {camera.width, camera.height}, kFlowFactor) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<Alcantarilla2012Method>(*this);
  }

  [[nodiscard]] std::shared_ptr<const MotionPreparation> prepare(
      const Frame& frame, std::span<const std::shared_ptr<const MotionPreparation>> past,
      int) const override {
    const Stopwatch watch;
    auto preparation = std::make_shared<Preparation>();
    auto images = std::make_shared<FlowImages>();
    const RgbdView view = make_rgbd_view(frame.gray, frame.depth, camera_, kFlowFactor);
    images->index = frame.index;
    view.gray.convertTo(images->gray, CV_8U);
    images->depth = view.depth;
    const bool usual = frame.gray.cols == camera_.width && frame.gray.rows == camera_.height;
    images->rays = usual ? rays_ : PixelRays(camera_, frame.gray.size(), kFlowFactor);
    if (!past.empty() && past.back()) {
      const auto& before = static_cast<const Preparation&>(*past.back()).images;
      // Only neighbours: a run that begins from a checkpoint finds the same one.
      if (before->index == frame.index - 1 && before->gray.size() == images->gray.size() &&
          std::min(images->gray.cols, images->gray.rows) >= kLeastFlowSide) {
        preparation->last = before;
        preparation->flow = dense_flow(images->gray, before->gray);
      }
    }
    preparation->images = std::move(images);
    preparation->ms = watch.milliseconds();
    return preparation;
  }
  [[nodiscard]] int frames_prepared_back() const override { return 1; }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    const Preparation& ready = prepared(input);
    MotionResult result;
    if (!ready.last || !last_ || last_->index != ready.last->index) {
      result.note = "there is no frame right before, with depth and a measured pose, to compare with";
      return result;
    }
    auto trace = std::make_shared<Alcantarilla2012Trace>();
    trace->here = ready.images, trace->last = ready.last, trace->flow = ready.flow;
    trace->ms_flow = ready.ms;
    Stopwatch watch;
    const std::vector<JudgedPixel> pixels = judged_pixels(*ready.images, *ready.last, ready.flow, config_);
    const cv::Size small = ready.images->gray.size();
    trace->judged = cv::Mat::zeros(small, CV_8UC1);
    for (const JudgedPixel& pixel : pixels) trace->judged.at<std::uint8_t>(pixel.y, pixel.x) = 255;
    trace->ms_pairs = watch.lap();

    const Camera camera = camera_.scaled_to(input.frame.gray.cols, input.frame.gray.rows);
    std::vector<std::uint8_t> left_out(input.features.size(), 0);
    Pose pose = *input.camera_from_world;
    for (int round = 0; round < config_.rounds; ++round) {
      Alcantarilla2012Round next;
      next.left_out = static_cast<int>(std::count(left_out.begin(), left_out.end(), 1));
      if (round > 0 && next.left_out == 0) break;  // the pose would come out as before
      next.pose = pose_of_features(input.features, left_out, pose, camera);
      if (round > 0 && !next.pose.found) break;
      // The odometry's own first pose is the better one of the first round: it stood its RANSAC.
      if (round > 0) pose = next.pose.camera_from_world;
      next.here_from_last = pose * last_->camera_from_world.inverse();
      next.ms_pose = watch.lap();
      next.test = test_flow(pixels, small, CameraMotion(next.here_from_last, next.pose.covariance),
                            noise(ready.images->rays), config_);
      next.ms_test = watch.lap();
      for (std::size_t i = 0; i < left_out.size(); ++i)
        left_out[i] = moves(next.test.voted, input.features[i]) ? 1 : 0;
      trace->rounds.push_back(std::move(next));
    }
    const FlowTest& last_test = trace->rounds.back().test;
    trace->mask = enlarged(last_test.voted, kFlowFactor, input.frame.gray.size());
    result.mask = trace->mask;
    result.mask_share = percent_set(trace->mask) / 100.0;
    result.rounds = static_cast<int>(trace->rounds.size());
    const double judged = percent_set(trace->judged);
    result.figures = {judged / 100.0, judged > 0.0 ? percent_set(last_test.moving) / judged : 0.0};
    trace->contradicted = contradicted(input.features, trace->rounds.front().pose.is_inlier, last_test.voted);
    if (result.figures[1] > config_.most_moving && trace->contradicted > config_.most_contradicted) {
      // It is the camera's motion that does not fit, or depth that lags behind it: such a mask would empty
      // the map.
      trace->mask.setTo(0);
      result.mask_share = 0.0;
      result.note = fmt::format(
          "{:.0f} % of the features that agree with the pose move: it is doubted, and nothing is dropped",
          100.0 * trace->contradicted);
    }
    if (pixels.empty()) result.note = "no pixel has depth and flow that can be trusted: nothing is judged";
    result.trace = std::move(trace);
    return result;
  }

  void commit(const MotionInput& input, const MotionResult&, const MotionOutcome& outcome) override {
    last_.reset();
    if (outcome.estimated) last_ = Last{input.frame.index, outcome.camera_from_world};
  }

  [[nodiscard]] bool settled() const override { return last_.has_value(); }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    auto method = std::make_unique<Alcantarilla2012Method>(*this);
    method->config_ = config.of<Alcantarilla2012Config>().for_camera(camera_);
    return method;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    if (result.trace)
      return describe_alcantarilla2012(frame, static_cast<const Alcantarilla2012Trace&>(*result.trace),
                                       config_);
    StageLog log;
    log.note = result.note;
    return log;
  }

 private:
  /// A frame whose pose was measured.
  struct Last {
    int index = -1;
    Pose camera_from_world = Pose::Identity();
  };

  [[nodiscard]] SceneFlowNoise noise(const PixelRays& rays) const {
    return {config_.flow_sigma_px / rays.fx(), config_.flow_sigma_px / rays.fy(), config_.depth_sigma_per_m2,
            config_.depth_floor_m};
  }

  /// As the odometry will find it in the mask.
  static bool moves(const cv::Mat& voted, const MotionFeature& feature) {
    const int x = std::clamp(cvRound(feature.pixel.x) / kFlowFactor, 0, voted.cols - 1);
    const int y = std::clamp(cvRound(feature.pixel.y) / kFlowFactor, 0, voted.rows - 1);
    return voted.at<std::uint8_t>(y, x) != 0;
  }

  /// Share of the features that agree with the map and the pose, and yet lie on what moves; 0 where none
  /// agree.
  static double contradicted(std::span<const MotionFeature> features, const std::vector<std::uint8_t>& agrees,
                             const cv::Mat& voted) {
    int all = 0, moving = 0;
    for (std::size_t i = 0; i < agrees.size(); ++i)
      if (agrees[i] != 0) ++all, moving += moves(voted, features[i]) ? 1 : 0;
    return all == 0 ? 0.0 : static_cast<double>(moving) / all;
  }

  Camera camera_;
  Alcantarilla2012Config config_;
  PixelRays rays_;
  std::optional<Last> last_;
};

}  // namespace

MethodInfo alcantarilla2012_method() {
  MethodInfo info;
  info.name = "alcantarilla2012";
  info.title = "Alcantarilla et al. 2012";
  info.summary =
      "Dense scene flow; what the camera's motion leaves of it is tested against its own covariance.";
  info.citation =
      "Alcantarilla P. F., Yebes J. J., Almazan J., Bergasa L. M.: On combining visual SLAM and dense scene "
      "flow to "
      "increase the robustness of localization and mapping in dynamic environments, ICRA 2012, 1290-1297";
  info.needs.depth = info.needs.first_pose = info.needs.matches = true;
  info.needs.keeps_state = true;
  info.needs.checkpoint_every = 4;
  info.without_depth = "epipolar";
  info.parameters = AnySection(Alcantarilla2012Config());
  info.figures = {
      {"alcantarilla2012_valid", FigureUnit::share, "pixels whose scene flow can be judged", 4},
      {"alcantarilla2012_moving", FigureUnit::share, "of those, the ones beyond the chi-squared limit", 4}};
  info.make = [](const Camera& camera, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<Alcantarilla2012Method>(camera, config.of<Alcantarilla2012Config>());
  };
  return info;
}

}  // namespace stillpoint
