#include "ui/session/feature_story.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/motion/paper/homography.hpp"
#include "core/motion/regions.hpp"
#include "ui/session/feature_trail.hpp"
#include "ui/session/reference_word.hpp"

namespace stillpoint {
namespace {

bool in_mask(const cv::Mat& mask, const Eigen::Vector2d& pixel) {
  if (mask.empty()) return false;
  const int x = cvRound(pixel.x()), y = cvRound(pixel.y());
  return x >= 0 && y >= 0 && x < mask.cols && y < mask.rows && mask.at<std::uint8_t>(y, x) != 0;
}

template <typename T>
std::optional<double> value_at(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  if (image.empty()) return std::nullopt;
  const int x = cvRound(pixel.x()), y = cvRound(pixel.y());
  if (x < 0 || y < 0 || x >= image.cols || y >= image.rows) return std::nullopt;
  const auto value = static_cast<double>(image.at<T>(y, x));
  if (std::isnan(value)) return std::nullopt;
  return value;
}

/// What the paper's stages say at a target pixel.
struct PaperSays {
  bool forward = false, backward = false, in_union = false;
  std::optional<int> since_round, region;
  int region_px = 0;
};

PaperSays ask_paper(const PaperTrace& motion, const Eigen::Vector2d& pixel) {
  PaperSays says;
  if (motion.rounds.empty()) return says;
  const MotionRound& last = motion.rounds.back();
  says.forward = in_mask(last.forward.mask, pixel);
  says.backward = in_mask(last.backward_mask_in_target, pixel);
  says.in_union = in_mask(last.mask, pixel);
  if (!says.in_union) return says;
  for (std::size_t i = motion.rounds.size(); i-- > 0 && in_mask(motion.rounds[i].mask, pixel);)
    says.since_round = static_cast<int>(i);
  if (const auto label = value_at<int>(last.labels, pixel); label && *label > 0) {
    says.region = static_cast<int>(*label);
    says.region_px = last.regions[static_cast<std::size_t>(*says.region - 1)].area;
  }
  return says;
}

void add_difference(const DirectionTrace& direction, const char* name, const Eigen::Vector2d& pixel,
                    std::vector<Margin>& margins) {
  const auto difference = value_at<std::uint8_t>(direction.difference, pixel);
  if (!difference || !in_mask(direction.valid, pixel)) return;
  margins.push_back({name, *difference, direction.threshold, "grey levels"});
}

void tell_paper(const FrameView& view, FeatureStory& story) {
  const PaperTrace& motion = view.motion;
  if (motion.rounds.empty()) return;
  const Eigen::Vector2d pixel(story.feature.pixel.x, story.feature.pixel.y);
  const MotionRound& last = motion.rounds.back();
  add_difference(last.forward, "Forward difference", pixel, story.margins);
  if (!last.backward.difference.empty()) {
    const cv::Point2d there = carry(last.backward.homography.matrix, {pixel.x(), pixel.y()});
    add_difference(last.backward, "Backward difference", {there.x, there.y}, story.margins);
  }
  const PaperSays says = ask_paper(motion, pixel);
  if (!says.in_union) return;
  story.since_round = says.since_round;
  story.region = says.region;
  story.because.push_back(
      fmt::format("The {} hold{} it: region {}, {} px, in the union since round {} of {}.",
                  says.forward && says.backward ? "forward and the backward mask"
                  : says.forward                ? "forward mask alone"
                                                : "backward mask alone",
                  says.forward && says.backward ? "" : "s", says.region.value_or(0), says.region_px,
                  says.since_round.value_or(0) + 1, motion.rounds.size()));
  const bool above = std::any_of(story.margins.begin(), story.margins.end(),
                                 [](const Margin& margin) { return margin.margin() > 0.0; });
  if (above || story.margins.empty()) return;
  const auto raw = distance_to_edge(last.forward.raw_mask, story.feature.pixel);
  story.because.push_back(
      raw ? fmt::format(
                "It differs less than the threshold itself: dilation spread the mask to it, from {:.0f} "
                "px away.",
                std::abs(*raw))
          : "It differs less than the threshold itself: dilation spread the mask to it.");
}

void tell_depth_motion(const FrameView& view, const Config& config, int factor, FeatureStory& story) {
  const StillpointTrace& trace = view.depth_motion;
  if (trace.log_odds.empty()) return;
  const Eigen::Vector2d small((static_cast<double>(story.feature.pixel.x) + 0.5) / factor - 0.5,
                              (static_cast<double>(story.feature.pixel.y) + 0.5) / factor - 0.5);
  const StillpointConfig& limits = config.depth_motion;
  const auto label = value_at<int>(trace.labels, small);
  const Segment* segment = nullptr;
  if (label && *label >= 0 && static_cast<std::size_t>(*label) < trace.segments.size()) {
    segment = &trace.segments[static_cast<std::size_t>(*label)];
    story.margins.push_back({fmt::format("Patch {:.0f}", *label), static_cast<double>(segment->log_odds),
                             limits.moving_log_odds, "log-odds"});
  }
  for (std::size_t i = 0; i < trace.references.size(); ++i) {
    const ReferenceEvidence& reference = trace.references[i];
    const char* which = reference_word(i);
    if (const auto residual = value_at<float>(reference.depth_residual, small))
      story.margins.push_back(
          {fmt::format("Depth, {} reference", which), *residual, limits.depth_sigmas, "σ"});
    if (const auto residual = value_at<float>(reference.intensity_residual, small))
      story.margins.push_back({fmt::format("Brightness, {} reference", which), *residual,
                               limits.intensity_sigmas * reference.intensity_sigma, "grey levels"});
    if (segment == nullptr || static_cast<std::size_t>(*label) >= reference.patches.size()) continue;
    const PatchMotion& patch = reference.patches[static_cast<std::size_t>(*label)];
    if (patch.log_odds != 0.0F)
      story.margins.push_back({fmt::format("Patch's shift, {} reference", which),
                               static_cast<double>(patch.log_odds), 0.0, "log-odds"});
  }
  if (story.feature.fate != FeatureFate::removed) return;
  if (segment != nullptr && segment->moving) {
    story.because.push_back(
        fmt::format("Its patch, {} small pixels at {:.2f} m, moves: its own evidence is {:.2f}, {:.2f} with "
                    "its neighbours'.",
                    segment->pixels, static_cast<double>(segment->depth),
                    static_cast<double>(segment->evidence), static_cast<double>(segment->log_odds)));
  } else {
    story.because.push_back(
        segment == nullptr
            ? "It has no depth: what has none beside a moving patch goes with it."
            : fmt::format(
                  "Its own patch is not held to move: the mask reaches it from beside, by its outline "
                  "or its margin of {} px.",
                  limits.margin_px));
  }
  if (trace.mask.empty()) return;
  const int region =
      find_regions(trace.mask).labels.at<int>(cvRound(story.feature.pixel.y), cvRound(story.feature.pixel.x));
  if (region > 0) story.region = region;
}

void tell_colour_motion(const FrameView& view, const Config& config, FeatureStory& story) {
  constexpr double kReach = 16.0;  // px: a point stands for what lies about it
  const EpipolarTrace& trace = view.colour_motion;
  if (trace.points.empty()) return;
  const EpipolarConfig& limits = config.colour_motion;
  const cv::Point2f& at = story.feature.pixel;
  const Eigen::Vector2d pixel(at.x, at.y);
  if (!trace.evidence.empty()) {
    const Eigen::Vector2d small((pixel.x() + 0.5) * trace.evidence.cols / view.frame.gray.cols - 0.5,
                                (pixel.y() + 0.5) * trace.evidence.rows / view.frame.gray.rows - 0.5);
    if (const auto spread = value_at<float>(trace.evidence, small))
      story.margins.push_back({"Spread evidence", *spread, limits.moving_evidence, ""});
  }
  const auto point = followed_point_near(trace, pixel, kReach);
  if (point) {
    const ColourPoint& near = trace.points[*point];
    story.margins.push_back(
        {"Followed point", static_cast<double>(near.evidence), limits.moving_evidence, ""});
    story.margins.push_back(
        {"… with neighbours'", static_cast<double>(near.shared), limits.moving_evidence, ""});
    for (const ColourReference& reference : trace.references)
      if (const auto off = unexplained_of(reference, *point))
        story.margins.push_back(
            {fmt::format("Unexplained, {} back", reference.gap), *off, limits.sigmas, "σ"});
  }
  if (story.feature.fate != FeatureFate::removed) return;
  for (std::size_t i = 0; i < trace.regions.size() && !story.region; ++i)
    if (trace.regions[i].box.contains({cvRound(at.x), cvRound(at.y)})) story.region = static_cast<int>(i) + 1;
  if (!point) {
    story.because.emplace_back("No followed point lies near it: evidence spread to it over like colours.");
    return;
  }
  const ColourPoint& near = trace.points[*point];
  const double distance =
      std::hypot(static_cast<double>(near.at.x) - pixel.x(), static_cast<double>(near.at.y) - pixel.y());
  const bool by_itself = static_cast<double>(near.evidence) > limits.moving_evidence;
  const bool with_others = static_cast<double>(near.shared) > limits.moving_evidence;
  story.because.push_back(fmt::format(
      "The point followed {:.0f} px away for {} frames {}.", distance, near.age,
      by_itself     ? "goes where the camera's own motion does not lead"
      : with_others ? "is held to move by the neighbours that move as it does"
                    : "is not held to move: evidence spread here from others, over like colours"));
}

std::string verdict_of(const FeatureStory& story, const std::string& method) {
  const FeatureRecord& feature = story.feature;
  switch (feature.fate) {
    case FeatureFate::removed:
      return story.region
                 ? fmt::format("Removed: region {} of method {}'s mask holds it.", *story.region, method)
                 : fmt::format("Removed: method {}'s mask holds it.", method);
    case FeatureFate::unmatched:
      return "Kept, but no map point was found for it.";
    case FeatureFate::inlier:
      return fmt::format("Kept and used: it agrees with the pose, {:.2f} px off{}.",
                         static_cast<double>(feature.residual_px),
                         feature.trust < kLittleTrust
                             ? fmt::format(", and weighs {:.0f} %, for it may move", 100.0 * feature.trust)
                             : "");
    case FeatureFate::outlier:
      return fmt::format("Kept and not used: matched to map point {}, but {:.1f} px off.", feature.map_point,
                         static_cast<double>(feature.residual_px));
  }
  return {};
}

/// Where it would be seen had it stood still: from its map point, else from where the flow says it was.
void tell_static_place(const FrameView& view, const PairGeometry& pair, const std::vector<SavedPoint>& points,
                       FeatureStory& story) {
  const auto point = std::lower_bound(points.begin(), points.end(), story.feature.map_point,
                                      [](const SavedPoint& saved, int id) { return saved.id < id; });
  const bool known =
      story.feature.map_point != kNone && point != points.end() && point->id == story.feature.map_point;
  if (known) {
    story.observations = point->observations;
    if (pair.world_from_target) {
      const Eigen::Vector3d seen = pair.world_from_target->inverse() * point->position;
      if (seen.z() > 0.05) {
        story.if_static = pair.camera.distort(pair.camera.project(seen));
        story.static_by = "its map point";
        return;
      }
    }
  }
  const auto from = flow_source(view, story.feature.pixel);
  if (!from) return;
  const auto carried = target_point(pair, FrameSpace::kReference,
                                    {static_cast<double>(from->x), static_cast<double>(from->y)});
  if (!carried) return;
  story.if_static = carried->pixel;
  story.static_by =
      carried->by == CarriedBy::kDepth ? "flow, depth and the camera's motion" : "flow and the homography";
}

}  // namespace

std::optional<double> FeatureStory::own_motion_px() const {
  if (!if_static) return std::nullopt;
  return (Eigen::Vector2d(feature.pixel.x, feature.pixel.y) - *if_static).norm();
}

FeatureStory explain_feature(const FrameView& view, const RunView& run, const SessionView& session,
                             int index) {
  FeatureStory story;
  story.index = index;
  story.feature = view.record->features.at(static_cast<std::size_t>(index));
  const std::string& method = session.config.run.method;
  const PairGeometry pair = pair_geometry(view, run, session.camera, session.config);
  const Eigen::Vector2d pixel(story.feature.pixel.x, story.feature.pixel.y);
  if (method == "stillpoint") tell_depth_motion(view, session.config, pair.small_factor, story);
  if (method == "stillpoint" && !view.frame.has_depth()) tell_colour_motion(view, session.config, story);
  if (method == "paper") tell_paper(view, story);
  story.verdict = verdict_of(story, method);
  story.mask_edge_px = distance_to_edge(view.mask, story.feature.pixel);
  story.trail = trail_of(view, index);
  story.in_camera = point_in_camera(pair, pixel);
  if (story.in_camera && pair.world_from_target) story.in_world = *pair.world_from_target * *story.in_camera;
  tell_static_place(view, pair, session.map_points, story);
  return story;
}

std::optional<std::size_t> followed_point_near(const EpipolarTrace& trace, const Eigen::Vector2d& pixel,
                                               double radius) {
  std::optional<std::size_t> nearest;
  double least = radius;
  for (std::size_t i = 0; i < trace.points.size(); ++i) {
    const cv::Point2f& at = trace.points[i].at;
    const double distance =
        std::hypot(static_cast<double>(at.x) - pixel.x(), static_cast<double>(at.y) - pixel.y());
    if (distance > least) continue;
    least = distance;
    nearest = i;
  }
  return nearest;
}

std::optional<double> unexplained_of(const ColourReference& reference, std::size_t point) {
  const auto at = std::find(reference.points.begin(), reference.points.end(), static_cast<int>(point));
  const auto k = static_cast<std::size_t>(at - reference.points.begin());
  if (at == reference.points.end() || k >= reference.sigmas.size()) return std::nullopt;
  return static_cast<double>(reference.sigmas[k]);
}

std::optional<double> distance_to_edge(const cv::Mat& mask, const cv::Point2f& pixel, int reach) {
  const int x = cvRound(pixel.x), y = cvRound(pixel.y);
  if (mask.empty() || x < 0 || y < 0 || x >= mask.cols || y >= mask.rows) return std::nullopt;
  const bool inside = mask.at<std::uint8_t>(y, x) != 0;
  double nearest = reach + 1.0;
  for (int v = std::max(0, y - reach); v <= std::min(mask.rows - 1, y + reach); ++v)
    for (int u = std::max(0, x - reach); u <= std::min(mask.cols - 1, x + reach); ++u)
      if ((mask.at<std::uint8_t>(v, u) != 0) != inside)
        nearest = std::min(nearest, std::hypot(static_cast<double>(u - x), static_cast<double>(v - y)));
  if (nearest > reach) return std::nullopt;
  return inside ? nearest : -nearest;
}

}  // namespace stillpoint
