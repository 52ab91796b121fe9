#include "core/motion/peng2017/peng2017_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/motion/dai2020/graph_layers.hpp"

namespace stillpoint {

int Peng2017Trace::cut_edges(double sigmas) const {
  return static_cast<int>(std::count_if(strains.begin(), strains.end(),
                                        [sigmas](double strain) { return std::abs(strain) > sigmas; }));
}

namespace {

constexpr const char* kGraph = "Graph";

std::vector<std::string> explained(const Peng2017Trace& trace, const Peng2017Config& config,
                                   const cv::Point2f& pixel) {
  const int feature = feature_near(trace.features, pixel);
  if (feature < 0) return {"This method judges features, and there is none here."};
  const auto f = static_cast<std::size_t>(feature);
  const int point = trace.nearest[f];
  if (point < 0)
    return {"No point of the graph lies near it at its depth.", sentence_of(PointVerdict::kUnjudged)};
  int all = 0, cut = 0;
  double largest = 0.0;
  for (std::size_t i = 0; i < trace.edges.size(); ++i) {
    if (trace.edges[i][0] != point && trace.edges[i][1] != point) continue;
    ++all;
    cut += std::abs(trace.strains[i]) > config.cut_sigmas ? 1 : 0;
    if (std::abs(trace.strains[i]) > std::abs(largest)) largest = trace.strains[i];
  }
  return {fmt::format("{} of its point's {} edges are cut; the most strained changed by {:+.1f} σ since the "
                      "last frame, and the limit is {:.1f}.",
                      cut, all, largest, config.cut_sigmas),
          sentence_of(trace.verdicts[f])};
}

}  // namespace

StageLog describe_peng2017(const Frame& frame, const Peng2017Trace& trace, const Peng2017Config& config) {
  StageLog log;
  log.reference = trace.last_index;
  log.reference_gray = trace.last_gray;
  const cv::Size size = frame.gray.size();
  const Layer photo = photo_layer(fmt::format("Frame {}", frame.index), frame.gray);

  std::vector<Mark> marks;
  for (std::size_t i = 0; i < trace.here.size(); ++i)
    marks.push_back({trace.here[i].pixel, trace.last[i].pixel, MarkKind::kInlier});
  for (const cv::Point2f& at : trace.unmeasured) marks.push_back({at, std::nullopt, MarkKind::kUnmatched});
  Layer tracks = marked("Points, and where they were", photo, std::move(marks));
  tracks.words = {{MarkKind::kInlier, "with depth"}, {MarkKind::kUnmatched, "without depth"}};
  tracks.id = "flow_tracks";
  Stage& points = log.add("points", kGraph, "Points",
                          "Follows features to the last frame and back, and measures depth at both ends.");
  points.ms = trace.ms_follow;
  points.figure("Points", static_cast<double>(trace.here.size()))
      .figure("Not measured", static_cast<double>(trace.unmeasured.size()));
  points.add_side({photo, photo_layer("Last frame", trace.last_gray, FrameSpace::kReference)}, tracks);

  const std::vector<float> strains(trace.strains.begin(), trace.strains.end());
  Layer strained = signed_layer("Strain of the edges", edge_image(size, trace.here, trace.edges, strains),
                                2.0 * config.cut_sigmas, "σ", FrameSpace::kTarget, config.cut_sigmas);
  strained.id = "strain";
  Stage& edges =
      log.add("strain", kGraph, "Strain",
              "How much each edge's length changed: (d - d') / σ, edges by Delaunay triangulation.");
  edges.ms = trace.ms_edges;
  edges.overview = true;
  edges.figure("Edges", static_cast<double>(trace.edges.size()))
      .figure("Cut", trace.cut_edges(config.cut_sigmas));
  edges.add_side({photo}, strained);

  Layer held;
  held.name = "Share of edges that hold";
  held.kind = LayerKind::kLength;
  held.image = point_image(size, trace.here, trace.shares);
  held.range = 1.0;
  held.id = "held_shares";
  std::vector<Mark> judged;
  for (std::size_t i = 0; i < trace.here.size(); ++i)
    judged.push_back({trace.here[i].pixel, std::nullopt, mark_of(trace.of_point[i])});
  Layer verdicts = marked("Points", photo, std::move(judged));
  verdicts.words = verdict_words();
  verdicts.id = "points";
  Stage& shares =
      log.add("shares", kGraph, "Edges that hold", "A point is static when most of its edges hold.");
  shares.timed = false;
  shares.figure("Dynamic points", static_cast<double>(std::count(trace.of_point.begin(), trace.of_point.end(),
                                                                 PointVerdict::kDynamic)));
  shares.add_side({held}, verdicts);

  Stage& features = log.add("classes", "Features", "Features", "Each feature takes after the nearest point.");
  features.timed = false;
  features.overview = true;
  const auto count = [&](PointVerdict verdict) {
    return static_cast<double>(std::count(trace.verdicts.begin(), trace.verdicts.end(), verdict));
  };
  features.figure("Static", count(PointVerdict::kStatic))
      .figure("Dynamic", count(PointVerdict::kDynamic))
      .figure("Not judged", count(PointVerdict::kUnjudged));
  features.add_side({photo}, feature_verdicts(photo, trace.features, trace.verdicts));

  log.explain = [trace, config](const cv::Point2f& pixel, bool) { return explained(trace, config, pixel); };
  return log;
}

}  // namespace stillpoint
