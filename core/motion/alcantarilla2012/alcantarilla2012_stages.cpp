#include "core/motion/alcantarilla2012/alcantarilla2012_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {
namespace {

constexpr const char* kFlow = "Scene flow";
constexpr float kFull = static_cast<float>(kFlowFactor);

class Stages {
 public:
  Stages(const Frame& frame, const Alcantarilla2012Trace& trace, const Alcantarilla2012Config& config,
         StageLog& log)
      : trace_(trace),
        config_(config),
        log_(log),
        frame_(photo_layer(fmt::format("Frame {}", frame.index), frame.gray)),
        small_(photo_layer("Frame at half size", trace.here->gray, FrameSpace::kSmall)) {}

  void add_all() {
    log_.small_factor = kFlowFactor;
    log_.reference = trace_.last->index;
    add_flow();
    add_pairs();
    for (std::size_t i = 0; i < trace_.rounds.size(); ++i) add_round(i);
    add_mask();
    // By value: what is explained outlives this.
    log_.explain = [rounds = trace_.rounds, judged = trace_.judged, config = config_](
                       const cv::Point2f& pixel, bool) { return explained(rounds, judged, config, pixel); };
  }

 private:
  static constexpr int kTrackStep = 12;  // small px between the flow's marks

  void add_flow() {
    const cv::Mat& flow = trace_.flow.last_from_here;
    cv::Mat length(flow.size(), CV_32FC1);
    std::vector<Mark> marks;
    for (int y = 0; y < flow.rows; ++y)
      for (int x = 0; x < flow.cols; ++x) {
        const cv::Vec2f back = flow.at<cv::Vec2f>(y, x);
        length.at<float>(y, x) = kFull * std::sqrt(back.dot(back));
        if (y % kTrackStep == kTrackStep / 2 && x % kTrackStep == kTrackStep / 2) {
          const cv::Point2f at = upsampled(cv::Point2f(static_cast<float>(x), static_cast<float>(y)), kFull);
          marks.push_back(
              {at, at + cv::Point2f(back[0], back[1]) * kFull,
               trace_.judged.at<std::uint8_t>(y, x) != 0 ? MarkKind::kInlier : MarkKind::kUnmatched});
        }
      }
    Layer lengths = length_layer("Length of the flow", length, "px", FrameSpace::kSmall);
    lengths.id = "flow_length";
    Layer tracks = marked("Flow: where pixels were", frame_, std::move(marks));
    tracks.words = {{MarkKind::kInlier, "valid"}, {MarkKind::kUnmatched, "not judged"}};
    tracks.id = "flow_tracks";
    Stage& stage =
        log_.add("flow", kFlow, "Dense flow",
                 "Finds for each pixel where it was in the last frame, and the other way, at half size.");
    stage.ms = trace_.ms_flow;
    stage.overview = true;
    stage.figure("Median length", median(length), "px", 1);
    stage.add_side(
        {small_, photo_layer("Last frame at half size", trace_.last->gray, FrameSpace::kReference)}, tracks,
        "Tracks");
    stage.add_side({small_}, lengths, "Length");
  }

  void add_pairs() {
    Stage& stage =
        log_.add("valid", kFlow, "Valid pixels",
                 "Keeps pixels with trusted depth in both frames whose flow leads there and back again.");
    stage.ms = trace_.ms_pairs;
    stage.figure("Valid", percent_set(trace_.judged), "%", 1);
    Layer depth = length_layer("Depth", trace_.here->depth, "m", FrameSpace::kSmall);
    stage.add_side({depth}, mask_layer("Valid pixels", trace_.judged, small_, "valid"));
  }

  void add_round(std::size_t index) {
    const Alcantarilla2012Round& round = trace_.rounds[index];
    const std::string group = fmt::format("Round {}", index + 1);
    const auto begin = [&](const char* id, const char* name, const char* what) -> Stage& {
      Stage& stage = log_.add(id, group, name, what);
      stage.round = static_cast<int>(index);
      return stage;
    };
    Stage& pose =
        begin("pose", "Camera's motion",
              index == 0 ? "Takes the odometry's first pose, and its covariance from the matched features."
                         : "Solves the pose again without the features on what moves.");
    pose.ms = round.ms_pose;
    const Matrix6d& covariance = round.pose.covariance;
    pose.figure("Travelled", 1000.0 * round.here_from_last.translation().norm(), "mm", 1)
        .figure("Turned", degrees(rotation_angle(round.here_from_last.linear())), "°", 2)
        .figure("Features used", round.pose.used)
        .figure("Inliers", round.pose.inliers)
        .figure("Left out", round.left_out)
        .figure("Sigma of a reprojection error", round.pose.sigma_px, "px", 2)
        .figure("Sigma of the position", 1000.0 * std::sqrt(covariance.topLeftCorner<3, 3>().trace()), "mm",
                2)
        .figure("Sigma of the rotation", degrees(std::sqrt(covariance.bottomRightCorner<3, 3>().trace())),
                "°", 3);
    if (!round.pose.found) pose.note = "Too few features agree: the pose counts as exact in the test.";

    Layer length = length_layer("|M|", round.test.length, "m", FrameSpace::kSmall);
    length.range = 0.1;
    length.id = "residual_motion";
    Stage& residual = begin("residual_motion", "Residual motion",
                            "Takes the camera's motion off the scene flow: M = X' - (R X + t).");
    residual.timed = false;
    residual.figure("Median |M|", 1000.0 * median(round.test.length), "mm", 1);
    residual.add_side({mask_layer("Valid pixels", trace_.judged, small_)}, length);

    Layer squared;
    squared.name = "ξ²";
    squared.kind = LayerKind::kLength;
    squared.image = round.test.chi_squared;
    squared.range = 4.0 * config_.chi_squared;
    squared.space = FrameSpace::kSmall;
    squared.limit = config_.chi_squared;
    squared.id = "chi_squared";
    Stage& test =
        begin("chi_squared", "Test", "Measures M by its own covariance: ξ² = Mᵀ Σ⁻¹ M, Σ = J S Jᵀ.");
    test.ms = round.ms_test;
    test.overview = index + 1 == trace_.rounds.size();
    const double valid = percent_set(trace_.judged);
    test.figure("Median ξ²", median(round.test.chi_squared), "", 2)
        .figure("Beyond the limit, of the valid",
                valid > 0.0 ? 100.0 * percent_set(round.test.moving) / valid : 0.0, "%", 1);
    test.add_side({length}, squared);

    Stage& vote = begin("vote", "Vote", "A place moves when over half of the valid pixels about it do.");
    vote.timed = false;
    vote.figure("Moves", percent_set(round.test.voted), "%", 2);
    vote.add_side({mask_layer("Beyond the limit", round.test.moving, small_, "beyond")},
                  mask_layer("Vote", round.test.voted, small_, "vote"));
  }

  void add_mask() {
    Stage& stage = log_.add("mask", "Detection", "Mask",
                            "The last round's vote at full size; features in it are dropped.");
    stage.timed = false;
    stage.overview = true;
    stage.figure("Mask", percent_set(trace_.mask), "%", 2)
        .figure("Moving, of the features that agree with the pose", 100.0 * trace_.contradicted, "%", 1);
    const FlowTest& test = trace_.rounds.back().test;
    stage.add_side({mask_layer("Vote", test.voted, small_)}, mask_layer("Mask", trace_.mask, frame_, "mask"));
  }

  static double degrees(double radians) { return radians * 180.0 / CV_PI; }

  /// Of the known values; 0 where there are none.
  static double median(const cv::Mat& values) {
    std::vector<float> known;
    for (int y = 0; y < values.rows; ++y)
      for (int x = 0; x < values.cols; ++x)
        if (const float value = values.at<float>(y, x); std::isfinite(value)) known.push_back(value);
    if (known.empty()) return 0.0;
    const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
    std::nth_element(known.begin(), middle, known.end());
    return static_cast<double>(*middle);
  }

  static std::vector<std::string> explained(const std::vector<Alcantarilla2012Round>& rounds,
                                            const cv::Mat& judged, const Alcantarilla2012Config& config,
                                            const cv::Point2f& pixel) {
    const int x = cvRound(pixel.x) / kFlowFactor, y = cvRound(pixel.y) / kFlowFactor;
    if (x < 0 || y < 0 || x >= judged.cols || y >= judged.rows) return {};
    const FlowTest& test = rounds.back().test;
    std::vector<std::string> sentences;
    if (judged.at<std::uint8_t>(y, x) == 0) {
      sentences.emplace_back(
          "Its own scene flow is not judged: depth is missing, too far or at an outline, or flow does "
          "not lead there and back.");
    } else {
      const auto squared = static_cast<double>(test.chi_squared.at<float>(y, x));
      sentences.push_back(
          fmt::format("Beside the camera's motion it moved {:.0f} mm since the last frame: ξ² is {:.1f}, {} "
                      "the limit of {:.2f}.",
                      1000.0 * static_cast<double>(test.length.at<float>(y, x)), squared,
                      squared > config.chi_squared ? "beyond" : "within", config.chi_squared));
    }
    sentences.emplace_back(
        test.voted.at<std::uint8_t>(y, x) != 0
            ? "Over half of the valid pixels about it are beyond the limit: it is dynamic."
            : "No majority of the valid pixels about it is beyond the limit: it is static.");
    return sentences;
  }

  const Alcantarilla2012Trace& trace_;
  const Alcantarilla2012Config& config_;
  StageLog& log_;
  Layer frame_, small_;
};

}  // namespace

StageLog describe_alcantarilla2012(const Frame& frame, const Alcantarilla2012Trace& trace,
                                   const Alcantarilla2012Config& config) {
  StageLog log;
  Stages(frame, trace, config, log).add_all();
  return log;
}

}  // namespace stillpoint
