#include "core/inspect/point_readings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/inspect/feature_explanation.hpp"
#include "core/inspect/feature_selection.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/scene_point.hpp"
#include "core/motion/stage_log.hpp"

namespace stillpoint {
namespace {

constexpr const char* kNothing = "–";
constexpr double kFeatureReach = 12.0;  // px of the frame: what one points at, and not past its neighbours

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

const char* by_text(WarpedBy by) {
  return by == WarpedBy::kDepth ? "by depth" : by == WarpedBy::kHomography ? "by homography" : "itself";
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
  return group;
}

/// One layer at a place of its own pixels; nothing at a place that is not known.
Reading read_layer(std::string name, const Layer& layer, const std::optional<Point>& place) {
  if (layer.kind == LayerKind::kMask)
    return place ? in_mask(std::move(name), layer.image, *place) : Reading{std::move(name), kNothing};
  const auto valid = place && !layer.valid.empty() ? level(layer.valid, *place) : std::nullopt;
  if (valid && *valid == 0) return {std::move(name), "no data"};
  std::optional<double> value;
  if (layer.image.depth() == CV_32F) {
    if (const auto real = place ? at<float>(layer.image, *place) : std::nullopt; real && !std::isnan(*real))
      value = static_cast<double>(*real);
  } else if (const auto grey_level = place ? level(layer.image, *place) : std::nullopt) {
    value = *grey_level;
  }
  if (!value) return {std::move(name), kNothing};
  const bool above = layer.limit && *value > *layer.limit;
  const bool is_level = layer.image.depth() == CV_8U;
  std::string text = is_level                           ? fmt::format("{:.0f}", *value)
                     : layer.kind == LayerKind::kSigned ? fmt::format("{:+.2f}", *value)
                                                        : fmt::format("{:.3f}", *value);
  if (layer.limit && *layer.limit != 0.0)
    text += fmt::format(" {} {:.{}f}", above ? ">" : "≤", *layer.limit, is_level ? 0 : 2);
  if (!layer.unit.empty()) text += " " + layer.unit;
  return {std::move(name), std::move(text), above};
}

/// The mark of a layer that is nearest to a place.
Reading read_marks(std::string name, const Layer& layer, const std::optional<Point>& place) {
  const Mark* nearest = nullptr;
  double least = kFeatureReach;
  for (const Mark& mark : layer.marks) {
    if (!place) break;
    const double away =
        std::hypot(static_cast<double>(mark.at.x) - place->x(), static_cast<double>(mark.at.y) - place->y());
    if (away > least) continue;
    least = away;
    nearest = &mark;
  }
  if (nearest == nullptr) return {std::move(name), kNothing};
  const bool speaks = nearest->kind == MarkKind::kRemoved || nearest->kind == MarkKind::kOutlier;
  return {std::move(name), fmt::format("{:.1f} px off, {}", least, layer.word_of(nearest->kind)), speaks};
}

/// What a method's stages made, a group of stages after the other; of rounds the newest first.
void read_stages(const StageLog& log, const PairGeometry& pair, const Point& target,
                 std::vector<ReadingGroup>& groups) {
  std::vector<ReadingGroup> found;
  for (const Stage& stage : log.stages) {
    for (const StageSide& side : stage.sides) {
      const Layer& layer = side.output;
      const bool photo = layer.kind == LayerKind::kPhoto;
      if (layer.elsewhere || (photo && layer.marks.empty()) || layer.image.channels() != 1) continue;
      const std::string title = fmt::format("{}: {}", log.method, stage.group);
      if (found.empty() || found.back().title != title) found.push_back({title, {}});
      const std::string name = side.name.empty() ? stage.name : fmt::format("{}, {}", stage.name, side.name);
      const auto place = scene_point_in(pair, layer.space, target);
      const auto pixel = place ? std::optional(place->pixel) : std::nullopt;
      found.back().readings.push_back(photo ? read_marks(name, layer, pixel)
                                            : read_layer(name, layer, pixel));
    }
  }
  if (log.rounds() > 0) std::reverse(found.begin(), found.end());
  groups.insert(groups.end(), found.begin(), found.end());
}

ReadingGroup read_result(const FrameView& view, const Point& target) {
  ReadingGroup group{"Result", {}};
  const bool known = view.record == nullptr || view.record->measured.mask;
  group.readings.push_back(!known              ? Reading{"Removed", kNothing}
                           : view.mask.empty() ? Reading{"Removed", "no"}
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

std::vector<ReadingGroup> read_point(const FrameView& view, const PairGeometry& pair,
                                     const Eigen::Vector2d& target) {
  std::vector<ReadingGroup> groups{read_place(view, pair, target), read_images(view, pair, target),
                                   read_result(view, target)};
  for (const auto& log : {view.motion, view.motion_beside, view.odometry})
    if (log) read_stages(*log, pair, target, groups);
  return groups;
}

}  // namespace stillpoint
