// The stages of method `stillpoint` where frames have no depth: points followed over some tenths of a second.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/median.hpp"
#include "ui/session/stage_pictures.hpp"

namespace stillpoint {
namespace {

constexpr const char* kMotion = "Followed points";
constexpr const char* kJudgement = "Judgement";
constexpr double kSmallerBy = 2.0;  // full-size px a side of a pixel that shifts are counted in

double share_of(double part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * part / static_cast<double>(whole);
}

/// Whether a point has been followed long enough to have a say.
bool has_say(const ColourPoint& point, const EpipolarConfig& config) { return point.age >= config.min_age; }

bool is_off(const ColourReference& reference, std::size_t k, const EpipolarConfig& config) {
  return static_cast<double>(reference.sigmas[k]) > config.sigmas;
}

void add_reference(const ColourReference& reference, int index, const EpipolarConfig& config,
                   std::vector<StageInfo>& stages) {
  const std::string group = fmt::format("{} frame{} back", reference.gap, reference.gap == 1 ? "" : "s");
  StageInfo& turn =
      add_stage(stages, StageKind::kCameraTurn, group, "Camera's motion",
                "The rotation and the direction of travel that explain where most points went.");
  turn.reference = index;
  turn.ms = reference.ms;
  const double cosine = 0.5 * (reference.motion.rotation.trace() - 1.0);
  add_figure(turn, "Camera turned", std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / CV_PI, "°", 2);
  add_figure(turn, "Points it explains", 100.0 * reference.motion.explained, "%", 1);
  add_figure(turn, "Points seen in both", static_cast<double>(reference.points.size()));
  const Eigen::Vector3d& way = reference.motion.direction;
  turn.note = reference.motion.turns_only
                  ? "The camera only turned: there is no parallax."
                  : fmt::format("The camera went elsewhere too, along ({:.2f}, {:.2f}, {:.2f}).", way.x(),
                                way.y(), way.z());

  StageInfo& off =
      add_stage(stages, StageKind::kUnexplained, group, "Unexplained",
                "What lies off the epipolar line of the camera's motion: parallax goes along it.");
  off.reference = index;
  off.timed = false;
  std::size_t count = 0;
  for (std::size_t k = 0; k < reference.sigmas.size(); ++k) count += is_off(reference, k, config) ? 1 : 0;
  add_figure(off, "Noise", kSmallerBy * reference.sigma, "px", 2);
  add_figure(off, "Above the limit", static_cast<double>(count));
  add_figure(off, "Of all", share_of(static_cast<double>(count), reference.sigmas.size()), "%", 1);
}

std::vector<PictureDot> point_dots(const EpipolarTrace& trace, const EpipolarConfig& config,
                                   float ColourPoint::*evidence) {
  std::vector<PictureDot> dots;
  for (const ColourPoint& point : trace.points) {
    if (!has_say(point, config)) continue;
    const bool moves = static_cast<double>(point.*evidence) > config.moving_evidence;
    dots.push_back({point.at, std::nullopt, moves ? DotKind::kRemoved : DotKind::kKept});
  }
  return dots;
}

/// Each point's way against one reference, several times as long. @param ways px of the small image
std::vector<PictureDot> way_dots(const EpipolarTrace& trace, const ColourReference& reference,
                                 const std::vector<cv::Point2f>& ways, float longer,
                                 const EpipolarConfig& config) {
  std::vector<PictureDot> dots;
  for (std::size_t k = 0; k < ways.size(); ++k) {
    const cv::Point2f at = trace.points[static_cast<std::size_t>(reference.points[k])].at;
    // Lines are drawn at twice the way to where they come from.
    const float scale = 0.5F * longer * static_cast<float>(kSmallerBy);
    dots.push_back(
        {at, at - scale * ways[k], is_off(reference, k, config) ? DotKind::kOutlier : DotKind::kInlier});
  }
  return dots;
}

StagePicture dotted(const char* heading, const FrameView& view, std::vector<PictureDot> dots) {
  StagePicture picture{heading, PictureLook::kPhoto, view.frame.gray};
  picture.dots = std::move(dots);
  return picture;
}

}  // namespace

void add_colour_stages(const FrameView& view, const Config& config, std::vector<StageInfo>& stages) {
  const EpipolarTrace& trace = view.colour_motion;
  const EpipolarConfig& limits = config.colour_motion;
  if (trace.points.empty()) return;
  StageInfo& points =
      add_stage(stages, StageKind::kFollowedPoints, kMotion, "Points",
                "Corners followed from frame to frame, forth and back; one a cell of the image.");
  points.ms = trace.ms.points;
  const auto with_say = std::count_if(trace.points.begin(), trace.points.end(),
                                      [&](const ColourPoint& point) { return has_say(point, limits); });
  add_figure(points, "Points", static_cast<double>(trace.points.size()));
  add_figure(points, "Followed long enough", static_cast<double>(with_say));
  std::vector<int> ages;
  for (const ColourPoint& point : trace.points) ages.push_back(point.age);
  add_figure(points, "Median age", median_of(ages), "frames");

  for (std::size_t i = 0; i < trace.references.size(); ++i)
    add_reference(trace.references[i], static_cast<int>(i), limits, stages);

  StageInfo& evidence = add_stage(
      stages, StageKind::kPointEvidence, kJudgement, "Evidence",
      "Adds up what points leave unexplained, frame by frame, and has them listen to neighbours that "
      "moved alike.");
  evidence.ms = trace.ms.evidence;
  const auto above = [&](float ColourPoint::*which) {
    return static_cast<double>(
        std::count_if(trace.points.begin(), trace.points.end(), [&](const ColourPoint& point) {
          return has_say(point, limits) && static_cast<double>(point.*which) > limits.moving_evidence;
        }));
  };
  add_figure(evidence, "Points that move by themselves", above(&ColourPoint::evidence));
  add_figure(evidence, "… with their neighbours", above(&ColourPoint::shared));

  StageInfo& spread = add_stage(stages, StageKind::kSpread, kJudgement, "Spread",
                                "Each pixel takes the evidence of the point it reaches over the least change "
                                "of colour.");
  spread.ms = trace.ms.spread;
  if (!trace.evidence.empty()) {
    const int over = cv::countNonZero(trace.evidence > limits.moving_evidence);
    add_figure(spread, "Above the limit", share_of(over, trace.evidence.total()), "%", 2);
  }

  StageInfo& mask = add_stage(stages, StageKind::kColourMask, kJudgement, "Mask",
                              "Gaps closed, small regions and those with few moving points dropped.");
  mask.ms = trace.ms.mask;
  add_figure(mask, "Mask", 100.0 * trace.mask_share, "%", 2);
  add_figure(mask, "Regions", static_cast<double>(trace.regions.size()));
  mask.note = trace.note;
}

StagePictures colour_pictures(const FrameView& view, const Config& config, const StageInfo& stage) {
  const EpipolarTrace& trace = view.colour_motion;
  const EpipolarConfig& limits = config.colour_motion;
  const StagePicture plain{fmt::format("Frame {}", view.frame.index), PictureLook::kPhoto, view.frame.gray};
  const auto index = static_cast<std::size_t>(std::max(stage.reference, 0));
  const bool of_reference = stage.kind == StageKind::kCameraTurn || stage.kind == StageKind::kUnexplained;
  if (trace.points.empty() || (of_reference && index >= trace.references.size())) return {{}, plain};

  StagePicture points = dotted("Points", view, {});
  for (const ColourPoint& point : trace.points)
    points.dots.push_back(
        {point.at, std::nullopt, has_say(point, limits) ? DotKind::kKept : DotKind::kUnmatched});
  const StagePicture own = dotted("By themselves", view, point_dots(trace, limits, &ColourPoint::evidence));
  const StagePicture shared =
      dotted("With their neighbours", view, point_dots(trace, limits, &ColourPoint::shared));
  cv::Mat large;
  if (!trace.evidence.empty())
    cv::resize(trace.evidence, large, view.frame.gray.size(), 0, 0, cv::INTER_NEAREST);
  const StagePicture spread{"Evidence", PictureLook::kSigned, large, {}, 1.0, ""};
  switch (stage.kind) {
    case StageKind::kFollowedPoints:
      return {{plain}, points};
    case StageKind::kCameraTurn: {
      const ColourReference& reference = trace.references[index];
      return {{points},
              dotted("Shifts beside the rotation, twice as long", view,
                     way_dots(trace, reference, reference.shifts, 2.0F, limits))};
    }
    case StageKind::kUnexplained: {
      const ColourReference& reference = trace.references[index];
      return {{dotted("Shifts beside the rotation, twice as long", view,
                      way_dots(trace, reference, reference.shifts, 2.0F, limits))},
              dotted("Unexplained, 8 times as long", view,
                     way_dots(trace, reference, reference.residuals, 8.0F, limits))};
    }
    case StageKind::kPointEvidence:
      return {{own}, shared};
    case StageKind::kSpread:
      return {{shared}, spread};
    default:
      return {{spread}, {"Mask", PictureLook::kMask, trace.mask, view.frame.gray}};
  }
}

}  // namespace stillpoint
