#include "core/motion/dai2020/dai2020_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/motion/dai2020/graph_layers.hpp"

namespace stillpoint {

int Dai2020Trace::cut_edges() const {
  return static_cast<int>(std::count_if(judged.edges.begin(), judged.edges.end(),
                                        [](const TrackedEdge& edge) { return edge.memory.cut; }));
}

namespace {

constexpr const char* kGraph = "Graph";
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

class Stages {
 public:
  Stages(const Frame& frame, const Dai2020Trace& trace, const Dai2020Config& config, StageLog& log)
      : trace_(trace),
        config_(config),
        log_(log),
        index_(frame.index),
        size_(frame.gray.size()),
        frame_(photo_layer(fmt::format("Frame {}", frame.index), frame.gray)) {
    for (const TrackedEdge& edge : trace.judged.edges) pairs_.push_back(edge.points);
  }

  void add_all() {
    if (!trace_.last_gray.empty()) {
      log_.reference = trace_.last_index;
      log_.reference_gray = trace_.last_gray;
      add_points();
      add_strain();
      add_cuts();
      add_groups();
      add_features();
    }
    add_keyframe();
    log_.explain = [trace = trace_, config = config_, index = index_](const cv::Point2f& pixel, bool) {
      return explained(trace, config, index, pixel);
    };
  }

 private:
  void add_points() {
    std::vector<Mark> marks;
    int measured = 0;
    for (std::size_t i = 0; i < trace_.before.size(); ++i) {
      const GraphPoint& seen = trace_.judged.seen[i];
      measured += seen.measured() ? 1 : 0;
      marks.push_back(
          {seen.pixel, trace_.before[i], seen.measured() ? MarkKind::kInlier : MarkKind::kUnmatched});
    }
    for (const cv::Point2f& at : trace_.lost) marks.push_back({at, std::nullopt, MarkKind::kLost});
    Layer tracks = marked("Points, and where they were", frame_, std::move(marks));
    tracks.words = {{MarkKind::kInlier, "with depth"}, {MarkKind::kUnmatched, "without depth"}};
    tracks.id = "flow_tracks";
    Stage& stage =
        log_.add("points", kGraph, "Points",
                 "Follows the graph's points from the last frame and back, and measures their depth.");
    stage.ms = trace_.ms_follow;
    stage.figure("Followed", static_cast<double>(trace_.before.size()))
        .figure("With depth", measured)
        .figure("Lost", static_cast<double>(trace_.lost.size()));
    stage.add_side({frame_, photo_layer("Last frame", trace_.last_gray, FrameSpace::kReference)}, tracks);
  }

  void add_strain() {
    std::vector<float> strains;
    int measured = 0, strained = 0;
    for (const TrackedEdge& edge : trace_.judged.edges) {
      strains.push_back(edge.measured ? static_cast<float>(edge.memory.strain) : kNothing);
      measured += edge.measured ? 1 : 0;
      strained += edge.measured && std::abs(edge.memory.strain) > config_.cut_sigmas ? 1 : 0;
    }
    Layer layer = signed_layer("Strain of the edges", edge_image(size_, trace_.judged.seen, pairs_, strains),
                               2.0 * config_.cut_sigmas, "σ", FrameSpace::kTarget, config_.cut_sigmas);
    layer.id = "strain";
    Stage& stage = log_.add("strain", kGraph, "Strain",
                            "Measures each edge's length against its mean so far: (d - d̂) / σ.");
    stage.ms = trace_.ms_edges;
    stage.overview = true;
    stage.figure("Edges", static_cast<double>(trace_.judged.edges.size()))
        .figure("Measured", measured)
        .figure("Strained", strained);
    stage.add_side({frame_}, layer);
  }

  void add_cuts() {
    std::vector<float> since;
    int now = 0;
    for (const TrackedEdge& edge : trace_.judged.edges) {
      const EdgeMemory& memory = edge.memory;
      // Cut in this frame would count as nothing.
      since.push_back(memory.cut ? static_cast<float>(index_ - memory.cut_at + 1) : kNothing);
      now += memory.cut && memory.cut_at == index_ ? 1 : 0;
    }
    Layer layer =
        length_layer("Frames since it was cut, from 1", edge_image(size_, trace_.judged.seen, pairs_, since),
                     "frames", FrameSpace::kTarget);
    layer.range = 30.0;
    layer.id = "cut_times";
    Stage& stage = log_.add("cuts", kGraph, "Cuts",
                            "Cuts edges that are strained again, and mends those that are calm for long.");
    stage.timed = false;
    stage.figure("Cut", trace_.cut_edges()).figure("Cut in this frame", now);
    stage.add_side({frame_}, layer);
  }

  void add_groups() {
    // Numbered by size, so that colours tell the same from frame to frame.
    std::vector<std::size_t> order(trace_.groups.groups.size());
    for (std::size_t g = 0; g < order.size(); ++g) order[g] = g;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return trace_.groups.groups[a].points.size() > trace_.groups.groups[b].points.size();
    });
    std::vector<float> number(order.size());
    for (std::size_t k = 0; k < order.size(); ++k)
      number[order[k]] = static_cast<float>(std::min<std::size_t>(k + 1, kMostGroups));
    std::vector<float> values;
    std::vector<Mark> marks;
    for (std::size_t i = 0; i < trace_.judged.points.size(); ++i) {
      const int group = trace_.groups.of_point[i];
      values.push_back(group < 0 ? kNothing : number[static_cast<std::size_t>(group)]);
      marks.push_back({trace_.judged.seen[i].pixel, std::nullopt, mark_of(trace_.judged.points[i].verdict)});
    }
    Layer layer;
    layer.name = "Groups by size";
    layer.kind = LayerKind::kClasses;
    layer.range = kMostGroups;
    cv::Mat image = point_image(size_, trace_.judged.seen, values);
    cv::patchNaNs(image, 0.0);
    image.convertTo(layer.image, CV_8U);
    layer.id = "groups";
    Layer points = marked("Points", frame_, std::move(marks));
    points.words = verdict_words();
    points.id = "points";
    Stage& stage = log_.add("groups", kGraph, "Groups",
                            "Joins points by settled edges that hold; the largest group is static.");
    stage.ms = trace_.ms_groups;
    stage.overview = true;
    const auto large =
        std::count_if(trace_.groups.groups.begin(), trace_.groups.groups.end(), [&](const PointGroup& group) {
          return group.points.size() >= static_cast<std::size_t>(config_.least_group);
        });
    stage.figure("Groups large enough", static_cast<double>(large));
    if (trace_.still >= 0) {
      const PointGroup& still = trace_.groups.groups[static_cast<std::size_t>(trace_.still)];
      stage.figure("Points of the static group", static_cast<double>(still.points.size()))
          .figure("Hull of the static group", 100.0 * still.hull_area_px2 / static_cast<double>(size_.area()),
                  "% of the image", 1);
    } else {
      stage.note = "No edge has settled yet.";
    }
    stage.add_side({layer}, points);
  }

  void add_features() {
    Stage& stage =
        log_.add("classes", "Features", "Features", "Each feature takes after the nearest judged point.");
    stage.timed = false;
    stage.overview = true;
    const auto count = [&](PointVerdict verdict) {
      return static_cast<double>(std::count(trace_.verdicts.begin(), trace_.verdicts.end(), verdict));
    };
    stage.figure("Static", count(PointVerdict::kStatic))
        .figure("Dynamic", count(PointVerdict::kDynamic))
        .figure("Undecided", count(PointVerdict::kUndecided))
        .figure("Not judged", count(PointVerdict::kUnjudged));
    stage.add_side({frame_}, feature_verdicts(frame_, trace_.features, trace_.verdicts));
  }

  void add_keyframe() {
    std::vector<Mark> marks;
    for (std::size_t i = 0; i < trace_.next.seen.size(); ++i)
      marks.push_back({trace_.next.seen[i].pixel, std::nullopt,
                       i < trace_.judged.seen.size() ? MarkKind::kInlier : MarkKind::kGained});
    for (const TrackedEdge& edge : trace_.next.edges)
      if (edge.memory.life == 0)
        marks.push_back({trace_.next.seen[static_cast<std::size_t>(edge.points[0])].pixel,
                         trace_.next.seen[static_cast<std::size_t>(edge.points[1])].pixel,
                         MarkKind::kGained});
    Layer layer = marked("Points and new edges", frame_, std::move(marks));
    layer.words = {{MarkKind::kInlier, "point"}, {MarkKind::kGained, "new point or edge"}};
    layer.id = "new_edges";
    Stage& stage = log_.add("keyframe", "Keyframe", "Triangulation",
                            "At a keyframe features become points; edges of a new triangulation are added.");
    stage.ms = trace_.ms_keyframe;
    stage.figure("New points", trace_.added)
        .figure("Points", static_cast<double>(trace_.next.points.size()))
        .figure("Edges", static_cast<double>(trace_.next.edges.size()));
    if (!trace_.keyframe)
      stage.note =
          fmt::format("No keyframe: {} frames after the last one.", trace_.next.frames_since_keyframe);
    stage.add_side({frame_}, layer);
  }

  static std::vector<std::string> explained(const Dai2020Trace& trace, const Dai2020Config& config, int frame,
                                            const cv::Point2f& pixel) {
    const int feature = feature_near(trace.features, pixel);
    if (feature < 0) return {"This method judges features, and there is none here."};
    const auto f = static_cast<std::size_t>(feature);
    if (f >= trace.nearest.size()) return {"The graph begins with this frame: nothing is judged."};
    const int point = trace.nearest[f];
    if (point < 0)
      return {"No judged point of the graph lies near it at its depth.",
              sentence_of(PointVerdict::kUnjudged)};
    int edges = 0, cut = 0, newest = -1;
    double largest = 0.0;
    for (const TrackedEdge& edge : trace.judged.edges) {
      if (edge.points[0] != point && edge.points[1] != point) continue;
      ++edges;
      if (edge.memory.cut) ++cut, newest = std::max(newest, edge.memory.cut_at);
      if (edge.measured && std::abs(edge.memory.strain) > std::abs(largest)) largest = edge.memory.strain;
    }
    std::vector<std::string> sentences;
    sentences.push_back(
        fmt::format("It takes after point {}, of whose {} edges {} are cut{}; the most strained is {:+.1f} σ "
                    "off its mean "
                    "length, and the limit {:.1f}.",
                    trace.judged.points[static_cast<std::size_t>(point)].id, edges, cut,
                    newest < 0 ? std::string() : fmt::format(" (the last one {} frames ago)", frame - newest),
                    largest, config.cut_sigmas));
    const auto& groups = trace.groups.groups;
    const auto group = static_cast<std::size_t>(trace.groups.of_point[static_cast<std::size_t>(point)]);
    sentences.push_back(
        fmt::format("Its group has {} points{}.", groups[group].points.size(),
                    static_cast<int>(group) == trace.still
                        ? std::string(", and is the largest")
                        : fmt::format("; the static one has {}",
                                      groups[static_cast<std::size_t>(trace.still)].points.size())));
    sentences.push_back(sentence_of(trace.verdicts[f]));
    return sentences;
  }

  // Groups with a colour of their own: more are hard to tell apart.
  static constexpr std::size_t kMostGroups = 8;

  const Dai2020Trace& trace_;
  const Dai2020Config& config_;
  StageLog& log_;
  int index_;
  cv::Size size_;
  Layer frame_;
  std::vector<PointPair> pairs_;
};

}  // namespace

StageLog describe_dai2020(const Frame& frame, const Dai2020Trace& trace, const Dai2020Config& config) {
  StageLog log;
  Stages(frame, trace, config, log).add_all();
  return log;
}

}  // namespace stillpoint
