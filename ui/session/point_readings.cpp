#include "ui/session/point_readings.hpp"

#include <fmt/format.h>

#include <cmath>

#include "core/motion/paper/homography.hpp"
#include "ui/session/feature_story.hpp"
#include "ui/session/reference_word.hpp"

namespace stillpoint {
namespace {

constexpr const char* kNothing = "–";
constexpr double kFeatureReach = 12.0;  // px

using Point = Eigen::Vector2d;

template <typename T>
std::optional<T> at(const cv::Mat& image, const Point& point) {
  if (image.empty() || !point.allFinite() || point.cwiseAbs().maxCoeff() > 1e6) return std::nullopt;
  const int x = cvRound(point.x()), y = cvRound(point.y());
  if (x < 0 || y < 0 || x >= image.cols || y >= image.rows) return std::nullopt;
  return image.at<T>(y, x);
}

std::optional<int> level(const cv::Mat& image, const Point& point) {
  const auto value = at<std::uint8_t>(image, point);
  if (!value) return std::nullopt;
  return static_cast<int>(*value);
}

std::string pixel_text(const Point& point) { return fmt::format("{:.1f}, {:.1f}", point.x(), point.y()); }

Reading grey(const char* name, const cv::Mat& image, const Point& point) {
  const auto value = level(image, point);
  return {name, value ? fmt::format("{} of 255", *value) : kNothing};
}

Reading in_mask(std::string name, const cv::Mat& mask, const Point& point) {
  const auto value = level(mask, point);
  if (!value) return {std::move(name), kNothing};
  return {std::move(name), *value != 0 ? "yes" : "no", *value != 0};
}

Reading signed_value(std::string name, const cv::Mat& image, const Point& point, const char* unit,
                     double limit) {
  const auto value = at<float>(image, point);
  if (!value || std::isnan(*value)) return {std::move(name), kNothing};
  const auto number = static_cast<double>(*value);
  return {std::move(name), fmt::format("{:+.2f} {}", number, unit), number > limit};
}

const char* by_text(CarriedBy by) {
  return by == CarriedBy::kDepth ? "by depth" : by == CarriedBy::kHomography ? "by homography" : "itself";
}

ReadingGroup read_place(const FrameView& view, const PairGeometry& pair, const Point& target) {
  ReadingGroup group{"Place", {}};
  group.readings.push_back({"Pixel in frame t", fmt::format("{:.0f}, {:.0f}", target.x(), target.y())});
  if (view.reference.readable()) {
    const auto there = scene_point_in(pair, FrameSpace::kReference, target);
    group.readings.push_back(
        {fmt::format("… in frame {}", view.reference.index),
         there ? fmt::format("{} {}", pixel_text(there->pixel), by_text(there->by)) : kNothing});
  }
  if (!view.frame.depth.empty()) {
    const auto z = depth_at_pixel(view.frame.depth, target);
    group.readings.push_back({"Depth", z ? fmt::format("{:.3f} m", *z) : "not measured"});
    const auto camera = point_in_camera(pair, target);
    const auto metres = [](const Eigen::Vector3d& p) {
      return fmt::format("{:.3f}, {:.3f}, {:.3f} m", p.x(), p.y(), p.z());
    };
    group.readings.push_back({"In the camera", camera ? metres(*camera) : kNothing});
    group.readings.push_back({"In the world", camera && pair.world_from_target
                                                  ? metres(*pair.world_from_target * *camera)
                                                  : kNothing});
  }
  return group;
}

ReadingGroup read_images(const FrameView& view, const PairGeometry& pair, const Point& target) {
  ReadingGroup group{"Brightness", {}};
  group.readings.push_back(grey("Frame t", view.frame.gray, target));
  if (!view.frame.colour.empty()) {
    const auto bgr = at<cv::Vec3b>(view.frame.colour, target);
    group.readings.push_back(
        {"Red, green, blue", bgr ? fmt::format("{}, {}, {}", (*bgr)[2], (*bgr)[1], (*bgr)[0]) : kNothing});
  }
  if (!view.reference.readable()) return group;
  const auto there = scene_point_in(pair, FrameSpace::kReference, target);
  const std::string name = fmt::format("Frame {}, same scene point", view.reference.index);
  group.readings.push_back(there ? grey(name.c_str(), view.reference.gray, there->pixel)
                                 : Reading{name, kNothing});
  if (view.motion.rounds.empty()) return group;
  group.readings.push_back(
      grey("Compensated, same pixel", view.motion.rounds.back().forward.compensated, target));
  return group;
}

/// One direction of a round, in the space its images have.
void read_direction(const DirectionTrace& direction, const std::string& name,
                    const std::optional<Point>& point, std::vector<Reading>& readings) {
  const std::string title = name + " difference";
  const auto difference = point ? level(direction.difference, *point) : std::nullopt;
  const auto valid = point ? level(direction.valid, *point) : std::nullopt;
  if (!difference || valid.value_or(0) == 0) {
    readings.push_back({title, difference ? "no data" : kNothing});
  } else {
    const bool above = *difference > direction.threshold;
    readings.push_back(
        {title, fmt::format("{} {} {:.0f}", *difference, above ? ">" : "≤", direction.threshold), above});
  }
  const auto raw = point ? level(direction.raw_mask, *point) : std::nullopt;
  const auto clean = point ? level(direction.mask, *point) : std::nullopt;
  const auto word = [](const std::optional<int>& value) {
    return !value ? kNothing : *value != 0 ? "yes" : "no";
  };
  readings.push_back(
      {name + " mask, raw → clean", fmt::format("{} → {}", word(raw), word(clean)), clean.value_or(0) != 0});
}

ReadingGroup read_round(const PaperTrace& motion, std::size_t index, const Point& target) {
  const MotionRound& round = motion.rounds[index];
  ReadingGroup group{fmt::format("Paper, round {} of {}", index + 1, motion.rounds.size()), {}};
  read_direction(round.forward, "Forward", target, group.readings);
  std::optional<Point> there;
  if (!round.backward.compensated.empty()) {
    const cv::Point2d carried = carry(round.backward.homography.matrix, {target.x(), target.y()});
    there = Point(carried.x, carried.y);
  }
  read_direction(round.backward, "Backward", there, group.readings);
  Reading united = in_mask("Union", round.mask, target);
  if (const auto label = at<int>(round.labels, target); united.speaks && label && *label > 0)
    united.value =
        fmt::format("region {}, {} px", *label, round.regions[static_cast<std::size_t>(*label - 1)].area);
  group.readings.push_back(std::move(united));
  return group;
}

void read_patch(const StillpointTrace& trace, const StillpointConfig& config, const Point& small,
                std::vector<Reading>& readings) {
  const auto label = at<int>(trace.labels, small);
  if (!label || *label < 0 || static_cast<std::size_t>(*label) >= trace.segments.size()) {
    readings.push_back({"Patch", kNothing});
    readings.push_back({"… its own evidence", kNothing});
    readings.push_back({"… with neighbours'", kNothing});
    return;
  }
  const Segment& segment = trace.segments[static_cast<std::size_t>(*label)];
  readings.push_back(
      {"Patch",
       fmt::format("{}, {} px, {}", *label, segment.pixels, segment.moving ? "moves" : "stands still"),
       segment.moving});
  readings.push_back(
      {"… its own evidence", fmt::format("{:+.2f} log-odds", static_cast<double>(segment.evidence))});
  readings.push_back({"… with neighbours'",
                      fmt::format("{:+.2f} {} {:.2f}", static_cast<double>(segment.log_odds),
                                  static_cast<double>(segment.log_odds) > config.moving_log_odds ? ">" : "≤",
                                  config.moving_log_odds),
                      segment.moving});
}

/// How far the point's patch lies from where the camera's motion would have it.
Reading read_shift(const StillpointTrace& trace, const ReferenceEvidence& reference, const std::string& which,
                   const Point& small) {
  std::string name = fmt::format("Patch's shift{}", which);
  const auto label = at<int>(trace.labels, small);
  if (!label || *label < 0 || static_cast<std::size_t>(*label) >= reference.patches.size())
    return {std::move(name), kNothing};
  const PatchMotion& patch = reference.patches[static_cast<std::size_t>(*label)];
  if (patch.log_odds == 0.0F) return {std::move(name), "says nothing"};
  return {
      std::move(name),
      fmt::format("{:.2f} px, {:+.2f} log-odds", cv::norm(patch.shift), static_cast<double>(patch.log_odds)),
      patch.log_odds > 0.0F};
}

ReadingGroup read_depth_motion(const StillpointTrace& trace, const StillpointConfig& config,
                               const Point& small, const Point& target) {
  ReadingGroup group{"Stillpoint", {}};
  auto& readings = group.readings;
  for (std::size_t i = 0; i < trace.references.size(); ++i) {
    const ReferenceEvidence& reference = trace.references[i];
    const std::string which = trace.references.size() == 1 ? "" : fmt::format(", {}", reference_word(i));
    readings.push_back(signed_value(fmt::format("Depth residual{}", which), reference.depth_residual, small,
                                    "σ", config.depth_sigmas));
    readings.push_back(signed_value(fmt::format("Brightness residual{}", which), reference.intensity_residual,
                                    small, "grey levels",
                                    config.intensity_sigmas * reference.intensity_sigma));
    readings.push_back(
        signed_value(fmt::format("Evidence{}", which), reference.log_odds, small, "log-odds", 0.0));
    if (!reference.patches.empty()) readings.push_back(read_shift(trace, reference, which, small));
  }
  readings.push_back(signed_value("Memory", trace.prior, small, "log-odds", 0.0));
  readings.push_back(signed_value("All evidence", trace.log_odds, small, "log-odds", config.moving_log_odds));
  read_patch(trace, config, small, readings);
  readings.push_back(in_mask("Small mask", trace.small_mask, small));
  readings.push_back(in_mask("Mask", trace.mask, target));
  return group;
}

ReadingGroup read_colour_motion(const EpipolarTrace& trace, const EpipolarConfig& config,
                                const cv::Size& size, const Point& target) {
  ReadingGroup group{"Stillpoint, colour alone", {}};
  auto& readings = group.readings;
  const auto point = followed_point_near(trace, target, kFeatureReach);
  const auto said = [&](std::string name, float evidence) {
    const auto value = static_cast<double>(evidence);
    const bool above = value > config.moving_evidence;
    readings.push_back({std::move(name),
                        fmt::format("{:+.2f} {} {:.2f}", value, above ? ">" : "≤", config.moving_evidence),
                        above});
  };
  if (!point) {
    for (const char* name : {"Followed point", "… its own evidence", "… with neighbours'"})
      readings.push_back({name, kNothing});
  } else {
    const ColourPoint& found = trace.points[*point];
    readings.push_back(
        {"Followed point", fmt::format("{:.1f} px off, for {} frames",
                                       std::hypot(static_cast<double>(found.at.x) - target.x(),
                                                  static_cast<double>(found.at.y) - target.y()),
                                       found.age)});
    said("… its own evidence", found.evidence);
    said("… with neighbours'", found.shared);
  }
  for (const ColourReference& reference : trace.references) {
    std::string name = fmt::format("Unexplained, {} back", reference.gap);
    const auto off = point ? unexplained_of(reference, *point) : std::nullopt;
    if (off)
      readings.push_back({std::move(name), fmt::format("{:.1f} σ", *off), *off > config.sigmas});
    else
      readings.push_back({std::move(name), kNothing});
  }
  if (!trace.evidence.empty()) {
    const Point small((target.x() + 0.5) * trace.evidence.cols / size.width - 0.5,
                      (target.y() + 0.5) * trace.evidence.rows / size.height - 0.5);
    if (const auto spread = at<float>(trace.evidence, small))
      said("Spread evidence", *spread);
    else
      readings.push_back({"Spread evidence", kNothing});
  }
  readings.push_back(in_mask("Mask", trace.mask, target));
  return group;
}

ReadingGroup read_result(const FrameView& view, const Point& target) {
  ReadingGroup group{"Result", {}};
  group.readings.push_back(view.mask.empty() ? Reading{"Removed", "no"}
                                             : in_mask("Removed", view.mask, target));
  if (!view.truth.moving.empty())
    group.readings.push_back(in_mask("Truly moving", view.truth.moving, target));
  if (view.record == nullptr || view.record->features.empty()) return group;
  Reading nearest{"Feature near it", kNothing};
  if (const auto index = feature_near(*view.record, target, kFeatureReach)) {
    const FeatureRecord& feature = view.record->features[static_cast<std::size_t>(*index)];
    const char* fate = feature.fate == FeatureFate::removed   ? "removed"
                       : feature.fate == FeatureFate::inlier  ? "inlier"
                       : feature.fate == FeatureFate::outlier ? "outlier"
                                                              : "unmatched";
    nearest.value = fmt::format("{:.1f} px off, {}",
                                std::hypot(static_cast<double>(feature.pixel.x) - target.x(),
                                           static_cast<double>(feature.pixel.y) - target.y()),
                                fate);
    nearest.speaks = feature.fate == FeatureFate::removed;
  }
  group.readings.push_back(std::move(nearest));
  return group;
}

}  // namespace

std::vector<ReadingGroup> read_point(const SessionView& session, const PairGeometry& pair,
                                     const Eigen::Vector2d& target) {
  const FrameView& view = *session.current;
  std::vector<ReadingGroup> groups{read_place(view, pair, target), read_images(view, pair, target),
                                   read_result(view, target)};
  if (!view.depth_motion.log_odds.empty()) {
    const auto small = scene_point_in(pair, FrameSpace::kSmall, target);
    groups.push_back(read_depth_motion(view.depth_motion, session.config.depth_motion, small->pixel, target));
  }
  if (!view.colour_motion.points.empty())
    groups.push_back(
        read_colour_motion(view.colour_motion, session.config.colour_motion, view.frame.gray.size(), target));
  for (std::size_t i = view.motion.rounds.size(); i-- > 0;)
    groups.push_back(read_round(view.motion, i, target));
  return groups;
}

}  // namespace stillpoint
