#include "core/motion/lin2017/lin2017_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillpoint {

int Lin2017Trace::count(FeatureClass kind) const {
  const std::vector<FeatureFlow>& flows = rounds.back().flows;
  return static_cast<int>(std::count_if(flows.begin(), flows.end(),
                                        [kind](const FeatureFlow& flow) { return flow.kind == kind; }));
}

namespace {

constexpr const char* kVirtual = "Virtual map points";
constexpr const char* kTracks = "Features";
constexpr int kDot = 2;  // px about a feature that its values are painted over

MarkKind mark_of(FeatureClass kind) {
  switch (kind) {
    case FeatureClass::kStatic:
      return MarkKind::kInlier;
    case FeatureClass::kMoving:
      return MarkKind::kRemoved;
    case FeatureClass::kStray:
      return MarkKind::kOutlier;
    case FeatureClass::kVirtual:
      return MarkKind::kGained;
    case FeatureClass::kUnjudged:
      break;
  }
  return MarkKind::kUnmatched;
}

const char* name_of(FeatureClass kind) {
  switch (kind) {
    case FeatureClass::kStatic:
      return "it is static";
    case FeatureClass::kMoving:
      return "it belongs to a thing that moves, and is dropped";
    case FeatureClass::kStray:
      return "it moves by itself, and is dropped in this frame";
    case FeatureClass::kVirtual:
      return "it matches a virtual map point of something that moved, and is dropped";
    case FeatureClass::kUnjudged:
      break;
  }
  return "it is not judged, and stays";
}

class Stages {
 public:
  Stages(const Frame& frame, const Lin2017Trace& trace, const Lin2017Config& config, StageLog& log)
      : trace_(trace),
        config_(config),
        log_(log),
        size_(frame.gray.size()),
        frame_(photo_layer(fmt::format("Frame {}", frame.index), frame.gray)) {}

  void add_all() {
    log_.reference = trace_.last_index;
    log_.reference_gray = trace_.last_gray;
    add_virtual_points();
    add_tracks();
    for (std::size_t i = 0; i < trace_.rounds.size(); ++i) add_round(i);
    add_virtual_after();
    log_.explain = [features = trace_.features, flows = trace_.rounds.back().flows, config = config_](
                       const cv::Point2f& pixel, bool) { return explained(features, flows, config, pixel); };
  }

 private:
  /// An image with a value about each place; NaN elsewhere.
  template <typename Value>
  [[nodiscard]] cv::Mat dots(const std::vector<cv::Point2f>& at, const Value& value_of) const {
    cv::Mat image(size_, CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
    for (std::size_t i = 0; i < at.size(); ++i) {
      const float value = value_of(i);
      if (!std::isfinite(value) || !std::isfinite(at[i].x) || std::abs(at[i].x) > 1e5F ||
          std::abs(at[i].y) > 1e5F)
        continue;
      const cv::Rect box(cvRound(at[i].x) - kDot, cvRound(at[i].y) - kDot, 2 * kDot + 1, 2 * kDot + 1);
      if (const cv::Rect inside = box & cv::Rect({0, 0}, size_); !inside.empty()) image(inside).setTo(value);
    }
    return image;
  }
  [[nodiscard]] std::vector<cv::Point2f> pixels() const {
    std::vector<cv::Point2f> at;
    for (const MotionFeature& feature : trace_.features) at.push_back(feature.pixel);
    return at;
  }
  [[nodiscard]] Layer age_layer(std::string name, const std::vector<cv::Point2f>& at,
                                const std::vector<VirtualPoint>& points, std::string id) const {
    Layer layer;
    layer.name = std::move(name);
    layer.kind = LayerKind::kLength;
    // Age 0 would count as nothing.
    layer.image = dots(at, [&](std::size_t i) { return static_cast<float>(points[i].age + 1); });
    layer.range = config_.virtual_frames + 1;
    layer.unit = "frames";
    layer.id = std::move(id);
    return layer;
  }

  void add_virtual_points() {
    Stage& stage = log_.add(
        "virtual_points", kVirtual, "Matching",
        "Moves virtual map points on and takes out the features that look like one and lie near it.");
    stage.ms = trace_.ms_virtual;
    const auto matched = std::count_if(trace_.virtual_matches.begin(), trace_.virtual_matches.end(),
                                       [](int f) { return f >= 0; });
    stage.figure("Virtual points", static_cast<double>(trace_.virtual_before.size()))
        .figure("Matched", static_cast<double>(matched));
    std::vector<Mark> marks;
    for (std::size_t k = 0; k < trace_.virtual_pixels.size(); ++k) {
      const cv::Point2f& at = trace_.virtual_pixels[k];
      if (!std::isfinite(at.x)) continue;
      const int feature = trace_.virtual_matches[k];
      if (feature >= 0)
        marks.push_back({trace_.features[static_cast<std::size_t>(feature)].pixel, at, MarkKind::kRemoved});
      else
        marks.push_back({at, std::nullopt, MarkKind::kUnmatched});
    }
    Layer matches = marked("Virtual points, and the features that match", frame_, std::move(marks));
    matches.words = {{MarkKind::kRemoved, "feature that matches"}, {MarkKind::kUnmatched, "virtual point"}};
    matches.id = "virtual_matches";
    stage.add_side({age_layer("Frames since they moved, from 1", trace_.virtual_pixels, trace_.virtual_before,
                              "virtual_age")},
                   matches);
  }

  void add_tracks() {
    std::vector<Mark> marks;
    int followed = 0, measured = 0;
    const std::vector<FeatureFlow>& flows = trace_.rounds.back().flows;
    for (std::size_t i = 0; i < flows.size(); ++i) {
      const FeatureFlow& flow = flows[i];
      followed += flow.followed ? 1 : 0;
      measured += flow.measured ? 1 : 0;
      if (flow.followed)
        marks.push_back({trace_.features[i].pixel, flow.before,
                         flow.measured ? MarkKind::kInlier : MarkKind::kUnmatched});
    }
    Layer tracks = marked("Features, and where they were", frame_, std::move(marks));
    tracks.words = {{MarkKind::kInlier, "with depth"}, {MarkKind::kUnmatched, "without depth"}};
    tracks.id = "flow_tracks";
    Stage& stage = log_.add("tracks", kTracks, "Tracks",
                            "Follows features to the last frame and back, and takes depth at both ends.");
    stage.ms = trace_.ms_follow;
    stage.overview = true;
    stage.figure("Features", static_cast<double>(flows.size()))
        .figure("Followed", followed)
        .figure("With depth in both", measured);
    stage.add_side({frame_, photo_layer("Last frame", trace_.last_gray, FrameSpace::kReference)}, tracks);
  }

  void add_round(std::size_t index) {
    const Lin2017Round& round = trace_.rounds[index];
    const std::string group = fmt::format("Round {}", index + 1);
    const bool last = index + 1 == trace_.rounds.size();
    const std::vector<cv::Point2f> at = pixels();
    Layer length;
    length.name = "|s| of the features";
    length.kind = LayerKind::kLength;
    length.image = dots(at, [&](std::size_t i) {
      return round.flows[i].measured ? round.flows[i].flow.norm() : std::numeric_limits<float>::quiet_NaN();
    });
    length.range = 0.1;
    length.unit = "m";
    length.limit = config_.least_flow_m;
    length.id = "scene_flow";
    Stage& flow = log_.add("scene_flow", group, "Scene flow",
                           "Takes the camera's motion off each feature's own: s = X' - (R X + t).");
    flow.round = static_cast<int>(index);
    flow.ms = round.ms;
    flow.overview = last;
    flow.figure("Travelled", 1000.0 * round.here_from_last.translation().norm(), "mm", 1)
        .figure("Turned", rotation_angle(round.here_from_last.linear()) * 180.0 / CV_PI, "°", 2)
        .figure("Features used for the pose", round.pose.used)
        .figure("Inliers", round.pose.inliers);
    if (!round.pose.found) flow.note = "Too few features agree: the pose counts as exact.";
    flow.add_side({frame_}, length);

    Layer bins;
    bins.name = fmt::format("Class of direction: elevation x {} + azimuth", config_.azimuth_bins);
    bins.kind = LayerKind::kClasses;
    bins.range = config_.azimuth_bins * config_.elevation_bins;
    dots(at, [&](std::size_t i) {
      return static_cast<float>(round.flows[i].bin + 1);
    }).convertTo(bins.image, CV_8U);
    bins.id = "directions";
    std::vector<Mark> marks;
    for (std::size_t i = 0; i < at.size(); ++i)
      marks.push_back({at[i], std::nullopt, mark_of(round.flows[i].kind)});
    Layer classes = marked("Classes", frame_, std::move(marks));
    classes.words = {{MarkKind::kInlier, "static"},
                     {MarkKind::kRemoved, "moving"},
                     {MarkKind::kOutlier, "stray"},
                     {MarkKind::kGained, "virtual"},
                     {MarkKind::kUnmatched, "not judged"}};
    classes.id = "classes";
    Stage& stage = log_.add(
        "classes", group, "Classes",
        "Sorts what moves by direction; a class whose features stand together is a thing that moves.");
    stage.round = static_cast<int>(index);
    stage.timed = false;
    stage.overview = last;
    const auto count = [&](FeatureClass kind) {
      return static_cast<double>(std::count_if(round.flows.begin(), round.flows.end(),
                                               [kind](const FeatureFlow& f) { return f.kind == kind; }));
    };
    stage.figure("Things that move", static_cast<double>(round.things.size()))
        .figure("Moving", count(FeatureClass::kMoving))
        .figure("Stray", count(FeatureClass::kStray))
        .figure("Virtual", count(FeatureClass::kVirtual))
        .figure("Static", count(FeatureClass::kStatic))
        .figure("Not judged", count(FeatureClass::kUnjudged));
    stage.add_side({bins}, classes);
  }

  void add_virtual_after() {
    std::vector<cv::Point2f> at;
    std::vector<VirtualPoint> of_now;
    const std::vector<FeatureFlow>& flows = trace_.rounds.back().flows;
    for (std::size_t i = 0; i < flows.size(); ++i)
      if (flows[i].kind == FeatureClass::kMoving)
        at.push_back(trace_.features[i].pixel), of_now.emplace_back();
    Stage& stage = log_.add("new_virtual_points", kVirtual, "New virtual points",
                            "Keeps the features that move, with their velocity, for the frames to come.");
    stage.timed = false;
    stage.figure("New or renewed", static_cast<double>(at.size()))
        .figure("Kept in all", static_cast<double>(trace_.virtual_after.size()));
    stage.add_side({frame_}, age_layer("New virtual points", at, of_now, "virtual_new"));
  }

  static std::vector<std::string> explained(const std::vector<MotionFeature>& features,
                                            const std::vector<FeatureFlow>& flows,
                                            const Lin2017Config& config, const cv::Point2f& pixel) {
    constexpr float kNear = 4.0F;  // px: a feature this near is meant
    std::size_t best = flows.size();
    float nearest = kNear;
    for (std::size_t i = 0; i < features.size(); ++i) {
      const cv::Point2f apart = features[i].pixel - pixel;
      if (const float distance = std::hypot(apart.x, apart.y); distance < nearest)
        nearest = distance, best = i;
    }
    if (best == flows.size()) return {"This method judges features, and there is none here."};
    const FeatureFlow& flow = flows[best];
    std::vector<std::string> sentences;
    if (!flow.measured)
      sentences.emplace_back(
          flow.followed
              ? "Its scene flow is not known: depth is missing, or at an outline, in one of the frames."
              : "It could not be followed to the last frame and back.");
    else
      sentences.push_back(fmt::format(
          "Beside the camera's motion it moved {:.0f} mm since the last frame ({:+.0f}, {:+.0f}, {:+.0f}); "
          "noise is {:.0f} mm, and the limit {:.0f} mm.",
          1000.0F * flow.flow.norm(), 1000.0F * flow.flow.x(), 1000.0F * flow.flow.y(),
          1000.0F * flow.flow.z(), 1000.0F * flow.sigma,
          1000.0 * std::max(config.sigmas * static_cast<double>(flow.sigma), config.least_flow_m)));
    if (flow.bin >= 0)
      sentences.push_back(fmt::format("Its direction is class {} of {}.", flow.bin + 1,
                                      config.azimuth_bins * config.elevation_bins));
    sentences.push_back(fmt::format("So {}.", name_of(flow.kind)));
    return sentences;
  }

  const Lin2017Trace& trace_;
  const Lin2017Config& config_;
  StageLog& log_;
  cv::Size size_;
  Layer frame_;
};

}  // namespace

StageLog describe_lin2017(const Frame& frame, const Lin2017Trace& trace, const Lin2017Config& config) {
  StageLog log;
  Stages(frame, trace, config, log).add_all();
  return log;
}

}  // namespace stillpoint
