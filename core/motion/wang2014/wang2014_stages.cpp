#include "core/motion/wang2014/wang2014_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {
namespace {

constexpr const char* kTracks = "Trajectories";
constexpr const char* kClusters = "Clusters";
constexpr const char* kMask = "Mask";
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
constexpr float kFull = static_cast<float>(kFlowFactor);
constexpr int kDot = 2;  // small px about a trajectory that its value is painted over

class Stages {
 public:
  Stages(const Frame& frame, const Wang2014Trace& trace, const Wang2014Config& config, StageLog& log)
      : trace_(trace),
        config_(config),
        log_(log),
        frame_(photo_layer(fmt::format("Frame {}", frame.index), frame.gray)),
        small_(photo_layer("Frame at half size", trace.here->gray, FrameSpace::kSmall)) {}

  void add_all() {
    log_.small_factor = kFlowFactor;
    if (trace_.last) log_.reference = trace_.last->index;
    add_trajectories();
    if (trace_.segments) {
      add_affinities();
      add_eigenvectors();
      add_clusters();
      add_merging();
    }
    add_mask();
    log_.explain = [segments = trace_.segments, labels = trace_.labels, mask = trace_.small_mask,
                    since = trace_.since](const cv::Point2f& pixel, bool) {
      return explained(segments.get(), labels, mask, since, pixel);
    };
  }

 private:
  [[nodiscard]] const TrajectoryPoint& newest(std::size_t chosen) const {
    return trace_.trajectories->all[static_cast<std::size_t>(trace_.segments->chosen[chosen])].back();
  }
  /// A value about each clustered trajectory, NaN elsewhere.
  [[nodiscard]] cv::Mat dots(const std::vector<float>& values) const {
    cv::Mat image(trace_.here->gray.size(), CV_32FC1, cv::Scalar(static_cast<double>(kNothing)));
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) continue;
      const cv::Point2f at = newest(i).small;
      const cv::Rect box(cvRound(at.x) - kDot, cvRound(at.y) - kDot, 2 * kDot + 1, 2 * kDot + 1);
      if (const cv::Rect inside = box & cv::Rect({0, 0}, image.size()); !inside.empty())
        image(inside).setTo(values[i]);
    }
    return image;
  }
  [[nodiscard]] Layer numbers(std::string name, const std::vector<int>& values, std::string id) const {
    std::vector<float> one_up;
    for (const int value : values) one_up.push_back(static_cast<float>(value + 1));
    Layer layer;
    layer.name = std::move(name);
    layer.kind = LayerKind::kClasses;
    cv::Mat image = dots(one_up);
    cv::patchNaNs(image, 0.0);
    image.convertTo(layer.image, CV_8U);
    layer.range = config_.most_clusters;
    layer.space = FrameSpace::kSmall;
    layer.id = std::move(id);
    return layer;
  }

  void add_trajectories() {
    std::vector<Mark> marks;
    int long_enough = 0, number = 0;
    for (const PointTrajectory& one : trace_.trajectories->all) {
      const bool fit = static_cast<int>(one.size()) >= config_.least_frames;
      long_enough += fit ? 1 : 0;
      // Every fourth: more hide the image.
      if (number++ % 4 == 0 && one.size() > 1)
        marks.push_back({upsampled(one.back().small, kFull), upsampled(one.front().small, kFull),
                         fit && one.back().measured() ? MarkKind::kInlier : MarkKind::kUnmatched});
    }
    Layer tracks = marked("Trajectories, and where they were", frame_, std::move(marks));
    tracks.words = {{MarkKind::kInlier, "long enough, with depth"},
                    {MarkKind::kUnmatched, "too short, or without depth"}};
    tracks.id = "flow_tracks";
    Stage& stage = log_.add("trajectories", kTracks, "Trajectories",
                            "Follows a grid of points by dense flow, there and back, from frame to frame.");
    stage.ms = trace_.ms_flow + trace_.ms_follow;
    stage.overview = true;
    stage.figure("Trajectories", static_cast<double>(trace_.trajectories->all.size()))
        .figure("Long enough", long_enough);
    std::vector<Layer> inputs{small_};
    if (trace_.last)
      inputs.push_back(photo_layer("Last frame at half size", trace_.last->gray, FrameSpace::kReference));
    stage.add_side(std::move(inputs), tracks);
  }

  void add_affinities() {
    const MotionSegments& segments = *trace_.segments;
    const cv::Size size = trace_.here->gray.size();
    const cv::Point2f wanted(static_cast<float>(config_.row_x * size.width),
                             static_cast<float>(config_.row_y * size.height));
    std::size_t shown = 0;
    for (std::size_t i = 0; i < segments.chosen.size(); ++i)
      if (cv::norm(newest(i).small - wanted) < cv::norm(newest(shown).small - wanted)) shown = i;
    const auto trajectory = [&](std::size_t i) -> const PointTrajectory& {
      return trace_.trajectories->all[static_cast<std::size_t>(segments.chosen[i])];
    };
    std::vector<float> row;
    std::vector<Mark> marks;
    for (std::size_t i = 0; i < segments.chosen.size(); ++i) {
      const double speed =
          speed_difference(segments.velocities[i], segments.velocities[shown], config_.noise_sigmas);
      const double distance = mean_distance(trajectory(i), trajectory(shown));
      row.push_back(speed < 0.0 || distance < 0.0
                        ? kNothing
                        : static_cast<float>(std::max(1e-3, affinity(speed, distance, config_))));
    }
    for (const AffinityEdge& edge : segments.edges) {
      const auto a = static_cast<std::size_t>(edge.a), b = static_cast<std::size_t>(edge.b);
      if (a != shown && b != shown) continue;
      marks.push_back({upsampled(newest(a == shown ? b : a).small, kFull),
                       upsampled(newest(shown).small, kFull),
                       edge.weight >= 0.5 ? MarkKind::kInlier : MarkKind::kOutlier});
    }
    Layer layer;
    layer.name = "Affinity to the chosen trajectory";
    layer.kind = LayerKind::kLength;
    layer.image = dots(row);
    layer.range = 1.0;
    layer.space = FrameSpace::kSmall;
    layer.id = "affinity_row";
    Layer kept =
        marked("Its neighbours in the graph (inlier: affinity of a half or more)", frame_, std::move(marks));
    kept.id = "affinity_neighbours";
    Stage& stage =
        log_.add("affinity", kClusters, "Affinities",
                 "Compares velocities in space: w = exp(-λ max ‖v - v'‖² D²), the neighbours' kept.");
    stage.ms = segments.ms_affinity;
    stage.figure("Clustered", static_cast<double>(segments.chosen.size()))
        .figure("Pairs", static_cast<double>(segments.edges.size()))
        .figure("Below a half", static_cast<double>(std::count_if(
                                    segments.edges.begin(), segments.edges.end(),
                                    [](const AffinityEdge& edge) { return edge.weight < 0.5; })));
    stage.add_side({frame_}, layer, "Row");
    stage.add_side({frame_}, kept, "Neighbours");
  }

  void add_eigenvectors() {
    const MotionSegments& segments = *trace_.segments;
    Stage& stage = log_.add("eigenvectors", kClusters, "Eigenvectors",
                            "The smallest of the normalised Laplacian I - D^-1/2 W D^-1/2.");
    stage.ms = segments.ms_spectrum;
    for (Eigen::Index c = 0; c < segments.spectrum.values.size(); ++c) {
      stage.figure(fmt::format("Eigenvalue {}", c + 1), segments.spectrum.values[c], "", 4);
      if (c == 0) continue;  // it tells the degrees alone
      const Eigen::VectorXd column = segments.spectrum.vectors.col(c);
      const std::vector<float> values(column.begin(), column.end());
      Layer layer = signed_layer(fmt::format("Eigenvector {}", c + 1), dots(values),
                                 column.cwiseAbs().maxCoeff(), "", FrameSpace::kSmall);
      layer.id = fmt::format("eigenvector_{}", c + 1);
      stage.add_side({small_}, layer, fmt::format("Vector {}", c + 1));
    }
    stage.figure("Clusters by the eigengap", segments.k);
  }

  void add_clusters() {
    Stage& stage = log_.add("clusters", kClusters, "Clusters", "k-means of the eigenvectors' rows.");
    stage.timed = false;
    stage.overview = true;
    for (int c = 0; c < trace_.segments->k; ++c)
      stage.figure(fmt::format("Cluster {}", c + 1),
                   static_cast<double>(
                       std::count(trace_.segments->cluster.begin(), trace_.segments->cluster.end(), c)));
    stage.add_side({small_}, numbers("Clusters", trace_.segments->cluster, "clusters"));
  }

  void add_merging() {
    const MotionSegments& segments = *trace_.segments;
    Stage& stage = log_.add("merging", kClusters, "Merging",
                            "Clusters whose rigid motions explain each other's points become one.");
    stage.ms = segments.ms_merge;
    stage.figure("Frames between", segments.baseline);
    for (std::size_t c = 0; c < segments.explained.size(); ++c)
      stage.figure(fmt::format("Cluster {} explained by the background", c + 1),
                   100.0 * segments.explained[c], "%", 0);
    stage.add_side({numbers("Clusters", segments.cluster, "")},
                   numbers("After merging", segments.label, "merged"));
  }

  void add_mask() {
    Layer labels;
    labels.name = "Labels";
    labels.kind = LayerKind::kClasses;
    labels.image = trace_.labels;
    labels.range = config_.most_clusters;
    labels.space = FrameSpace::kSmall;
    labels.id = "labels";
    if (!trace_.labels.empty()) {
      Stage& dense = log_.add(
          "labels", kMask, "Labels",
          trace_.segments
              ? "Each superpixel takes after its nearest trajectories in place, brightness and depth."
              : "Flow carries the last segmentation on.");
      dense.timed = false;
      dense.overview = true;
      dense.figure("Frames since the segmentation", trace_.since);
      if (trace_.segments) {
        dense.figure("Background's label", trace_.segments->background + 1)
            .figure("Rejoin it", static_cast<double>(trace_.segments->rejoined.size()));
        dense.ms = trace_.segments->ms_labels;
        dense.timed = true;
      }
      dense.add_side({small_}, labels);
    }
    Stage& stage = log_.add("mask", kMask, "Mask",
                            "What is neither the background's label nor fits its motion; holes are filled.");
    stage.ms = trace_.ms_mask;
    stage.overview = true;
    stage.figure("Mask", percent_set(trace_.mask), "%", 2);
    if (trace_.mask.empty())
      stage.note = "Nothing has been segmented yet.";
    else
      stage.add_side({labels}, mask_layer("Mask", trace_.mask, frame_, "mask"));
  }

  static std::vector<std::string> explained(const MotionSegments* segments, const cv::Mat& labels,
                                            const cv::Mat& mask, int since, const cv::Point2f& pixel) {
    if (labels.empty()) return {"Nothing has been segmented yet: it stays."};
    const int x = cvRound(pixel.x) / kFlowFactor, y = cvRound(pixel.y) / kFlowFactor;
    if (x < 0 || y < 0 || x >= labels.cols || y >= labels.rows) return {};
    const int label = labels.at<std::uint8_t>(y, x);
    std::vector<std::string> sentences;
    if (label == 0)
      sentences.emplace_back("No trajectory lies near it in place, brightness and depth: it has no label.");
    else if (segments == nullptr)
      sentences.push_back(
          fmt::format("Flow brought label {} here, {} frames after the segmentation.", label, since));
    else if (label - 1 == segments->background)
      sentences.push_back(
          fmt::format("Its label, {}, is the background: its motion explains most points.", label));
    else
      sentences.push_back(
          fmt::format("Its label is {}; the background's motion explains {:.0f} % of its points.", label,
                      100.0 * segments->explained[static_cast<std::size_t>(label - 1)]));
    sentences.emplace_back(mask.at<std::uint8_t>(y, x) != 0 ? "So it is dynamic." : "So it is static.");
    return sentences;
  }

  const Wang2014Trace& trace_;
  const Wang2014Config& config_;
  StageLog& log_;
  Layer frame_, small_;
};

}  // namespace

StageLog describe_wang2014(const Frame& frame, const Wang2014Trace& trace, const Wang2014Config& config) {
  StageLog log;
  Stages(frame, trace, config, log).add_all();
  return log;
}

}  // namespace stillpoint
