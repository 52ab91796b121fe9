#include "core/motion/yi2013/yi2013_stages.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace stillpoint {

double yi2013_share(const cv::Mat& matches, Yi2013Match match) {
  return static_cast<double>(cv::countNonZero(matches == match)) / static_cast<double>(matches.total());
}

namespace {

/// A frame's way through the method, as data.
class Stages {
 public:
  Stages(const Frame& frame, const Yi2013Trace& trace, const Yi2013Config& config, StageLog& log)
      : trace_(trace),
        config_(config),
        log_(log),
        gray_(trace.after->pyramid.front().clone()),
        frame_(photo_layer(fmt::format("Frame {}", frame.index), frame.gray)),
        filtered_(photo_layer(fmt::format("Frame {}, median", frame.index), gray_)) {}

  void add_all() {
    log_.small_factor = config_.block_px;
    if (trace_.last) add_motion();
    add_matches();
    add_update();
    add_mask();
    log_.explain = [gray = gray_, trace = trace_, config = config_](const cv::Point2f& pixel, bool) {
      return explained(gray, trace, config, pixel);
    };
  }

 private:
  static constexpr const char* kMotion = "Camera's motion";
  static constexpr const char* kModel = "Background model";
  static constexpr const char* kDetection = "Detection";

  [[nodiscard]] static Layer mean_layer(std::string name, const cv::Mat& mean, std::string id) {
    Layer layer = photo_layer(std::move(name), mean, FrameSpace::kSmall);
    layer.id = std::move(id);
    return layer;
  }
  [[nodiscard]] static Layer sigma_layer(std::string name, const cv::Mat& variance, std::string id) {
    cv::Mat sigma;
    cv::sqrt(variance, sigma);
    Layer layer = length_layer(std::move(name), sigma, "grey levels", FrameSpace::kSmall);
    layer.id = std::move(id);
    return layer;
  }
  [[nodiscard]] Layer age_layer(std::string name, const cv::Mat& age, std::string id) const {
    Layer layer = length_layer(std::move(name), age, "frames", FrameSpace::kSmall);
    layer.range = config_.max_age;
    layer.id = std::move(id);
    return layer;
  }

  void add_motion() {
    const Yi2013Motion& motion = trace_.motion;
    const cv::Mat last = trace_.last->pyramid.front().clone();
    const cv::Matx33d& h = motion.last_from_here;
    log_.reference = trace_.last->index;
    log_.reference_gray = last;
    if (std::abs(cv::determinant(h)) > 1e-12) log_.forward = h.inv(), log_.backward = h;

    std::vector<Mark> marks;
    for (const Yi2013Track& track : motion.tracks)
      marks.push_back({track.here, track.there, track.inlier ? MarkKind::kInlier : MarkKind::kOutlier});
    Layer tracks = marked("Grid points, and where they were", frame_, std::move(marks));
    tracks.id = "flow_tracks";
    Stage& flow = log_.add("flow", kMotion, "Grid flow",
                           "Follows the centres of a regular grid from this frame to the last.");
    flow.ms = trace_.ms_motion;
    flow.overview = true;
    flow.figure("Grid points", motion.points)
        .figure("Followed", static_cast<double>(motion.tracks.size()))
        .figure("Inliers", motion.inliers);
    flow.add_side({frame_, filtered_}, tracks);

    Layer warped = photo_layer("Last frame, warped", cv::Mat(), FrameSpace::kCompensatedForward);
    cv::warpPerspective(last, warped.image, h, last.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
    warped.id = "compensated";
    Stage& homography = log_.add("homography", kMotion, "Homography",
                                 "Finds where RANSAC's majority of the points was in the last frame.");
    homography.timed = false;
    homography.note = motion.note;
    for (int i = 0; i < 9; ++i)
      homography.figure(fmt::format("h{}{}", i / 3 + 1, i % 3 + 1), h(i / 3, i % 3), "", i >= 6 ? 7 : 4);
    homography.add_side({tracks, photo_layer("Last frame, median", last, FrameSpace::kReference)}, warped);
  }

  void add_matches() {
    Layer matches;
    matches.name = "Which matched: 1 apparent, 2 candidate, 3 neither";
    matches.kind = LayerKind::kClasses;
    cv::add(trace_.matches, cv::Scalar(1.0), matches.image);
    matches.range = kMatchNeither + 1;
    matches.space = FrameSpace::kSmall;
    matches.id = "matches";
    Stage& stage = log_.add("match", kModel, "Match",
                            "Warps the last model here, lets older candidates become apparent, and finds the "
                            "Gaussian each block belongs to.");
    stage.ms = trace_.ms_warp;
    stage.figure("Apparent", 100.0 * yi2013_share(trace_.matches, kMatchApparent), "%", 1)
        .figure("Candidate", 100.0 * yi2013_share(trace_.matches, kMatchCandidate), "%", 1)
        .figure("Neither", 100.0 * yi2013_share(trace_.matches, kMatchNeither), "%", 1);
    if (!trace_.last) stage.note = "The model begins with this frame.";
    stage.add_side({filtered_, mean_layer("Apparent mean, warped", trace_.chosen[0].mean, "warped_mean_0"),
                    age_layer("Apparent age, warped", trace_.chosen[0].age, "warped_age_0")},
                   matches);
  }

  void add_update() {
    const Yi2013Model &before = trace_.chosen, &after = trace_.after->model;
    Stage& stage = log_.add("update", kModel, "Update",
                            "Averages each block into the Gaussian it belongs to, by that Gaussian's age.");
    stage.ms = trace_.ms_update;
    stage.overview = true;
    stage.figure("Mean age, apparent", cv::mean(after[0].age)[0], "frames", 1)
        .figure("Mean age, candidate", cv::mean(after[1].age)[0], "frames", 1);
    const char* const names[] = {"Apparent", "Candidate"};
    for (std::size_t mode = 0; mode < 2; ++mode) {
      const std::string name = names[mode];
      stage.add_side({mean_layer("μ, warped", before[mode].mean, "")},
                     mean_layer("μ", after[mode].mean, fmt::format("mean_{}", mode)), name + " mean");
      stage.add_side({sigma_layer("σ, warped", before[mode].variance, "")},
                     sigma_layer("σ", after[mode].variance, fmt::format("sigma_{}", mode)), name + " sigma");
      stage.add_side({age_layer("Age, warped", before[mode].age, "")},
                     age_layer("Age", after[mode].age, fmt::format("age_{}", mode)), name + " age");
    }
  }

  void add_mask() {
    const cv::Mat& mask = trace_.mask;
    const int side = config_.block_px;
    cv::Mat deviation(mask.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
    for (int y = 0; y < trace_.matches.rows * side; ++y)
      for (int x = 0; x < trace_.matches.cols * side; ++x)
        if (static_cast<double>(trace_.chosen[0].age.at<float>(y / side, x / side)) > config_.settled_age)
          deviation.at<float>(y, x) = std::abs(gray_.at<std::uint8_t>(y, x) -
                                               trace_.after->model[0].mean.at<float>(y / side, x / side)) /
                                      std::sqrt(trace_.chosen[0].variance.at<float>(y / side, x / side));
    const double limit = std::sqrt(config_.moving_limit);
    Layer off;
    off.name = "Deviation from the apparent background";
    off.kind = LayerKind::kLength;
    off.image = deviation;
    off.range = 2.0 * limit;
    off.unit = "σ";
    off.limit = limit;
    off.id = "deviation";
    Stage& stage =
        log_.add("deviation", kDetection, "Deviation",
                 "Compares each pixel with its block's apparent Gaussian, where that is old enough.");
    stage.timed = false;
    stage.overview = true;
    stage.figure("Judged", percent_known(deviation), "%", 1);
    stage.add_side({filtered_, mean_layer("Apparent mean", trace_.after->model[0].mean, "")}, off);

    Stage& end =
        log_.add("mask", kDetection, "Mask", "Sets the pixels beyond the limit; nothing is cleaned up.");
    end.ms = trace_.ms_mask;
    end.overview = true;
    end.figure("Mask", percent_set(mask), "%", 2);
    end.add_side({off}, mask_layer("Mask", mask, frame_, "mask"));
  }

  static std::vector<std::string> explained(const cv::Mat& gray, const Yi2013Trace& trace,
                                            const Yi2013Config& config, const cv::Point2f& pixel) {
    const int x = cvRound(pixel.x), y = cvRound(pixel.y), bx = x / config.block_px, by = y / config.block_px;
    if (x < 0 || y < 0 || x >= gray.cols || y >= gray.rows) return {};
    if (bx >= trace.matches.cols || by >= trace.matches.rows)
      return {"It lies in a strip narrower than a block, where nothing is judged."};
    const Yi2013Gaussians &chosen = trace.chosen[0], &after = trace.after->model[0];
    const auto age = static_cast<double>(chosen.age.at<float>(by, bx));
    std::vector<std::string> sentences;
    if (age > config.settled_age) {
      const auto mean = static_cast<double>(after.mean.at<float>(by, bx));
      const double sigma = std::sqrt(static_cast<double>(chosen.variance.at<float>(by, bx)));
      const int level = gray.at<std::uint8_t>(y, x);
      const bool moves = trace.mask.at<std::uint8_t>(y, x) != 0;
      sentences.push_back(
          fmt::format("It is {} grey levels bright; the apparent background of its block is {:.1f} ± {:.1f}, "
                      "after {:.1f} "
                      "frames: {:.1f} σ away, {} the limit of {:.1f} σ.",
                      level, mean, sigma, age, std::abs(level - mean) / sigma, moves ? "beyond" : "within",
                      std::sqrt(config.moving_limit)));
    } else {
      sentences.push_back(fmt::format(
          "The apparent background of its block stands for {:.1f} frames: too few to judge by.", age));
    }
    const auto match = trace.matches.at<std::uint8_t>(by, bx);
    sentences.emplace_back(
        match == kMatchApparent    ? "The block as a whole belongs to the apparent background."
        : match == kMatchCandidate ? "The block as a whole belongs to the candidate background."
                                   : "The block as a whole begins the candidate background anew.");
    return sentences;
  }

  const Yi2013Trace& trace_;
  const Yi2013Config& config_;
  StageLog& log_;
  cv::Mat gray_;
  Layer frame_, filtered_;
};

}  // namespace

StageLog describe_yi2013(const Frame& frame, const Yi2013Trace& trace, const Yi2013Config& config) {
  StageLog log;
  Stages(frame, trace, config, log).add_all();
  return log;
}

}  // namespace stillpoint
