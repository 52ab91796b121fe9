#include "core/motion/epipolar/epipolar_stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/median.hpp"

namespace stillpoint {
namespace {

constexpr const char* kPoints = "Followed points";
constexpr const char* kJudgement = "Judgement";

double percent_of(double part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * part / static_cast<double>(whole);
}

class EpipolarStages {
 public:
  EpipolarStages(const Frame& frame, const EpipolarTrace& trace, const EpipolarConfig& config, StageLog& log)
      : trace_(trace),
        config_(config),
        log_(log),
        frame_(photo_layer(fmt::format("Frame {}", frame.index), frame.gray)) {}

  void add_all() {
    add_points();
    for (std::size_t i = 0; i < trace_.references.size(); ++i) add_reference(i);
    add_evidence();
  }

 private:
  /// Whether a point has been followed long enough to have a say.
  [[nodiscard]] bool has_say(const ColourPoint& point) const { return point.age >= config_.min_age; }
  [[nodiscard]] bool is_off(const ColourReference& reference, std::size_t k) const {
    return static_cast<double>(reference.sigmas[k]) > config_.sigmas;
  }
  [[nodiscard]] bool is_dynamic(const ColourPoint& point, float ColourPoint::*evidence) const {
    return has_say(point) && static_cast<double>(point.*evidence) > config_.moving_evidence;
  }
  [[nodiscard]] double count_dynamic(float ColourPoint::*evidence) const {
    return static_cast<double>(
        std::count_if(trace_.points.begin(), trace_.points.end(),
                      [&](const ColourPoint& point) { return is_dynamic(point, evidence); }));
  }

  [[nodiscard]] Layer points_layer() const {
    std::vector<Mark> marks;
    for (const ColourPoint& point : trace_.points)
      marks.push_back({point.at, std::nullopt, has_say(point) ? MarkKind::kKept : MarkKind::kUnmatched});
    Layer points = marked("Points", frame_, std::move(marks));
    points.words = {{MarkKind::kKept, "followed long enough"}, {MarkKind::kUnmatched, "too new"}};
    return points;
  }

  [[nodiscard]] Layer judged_layer(const char* name, float ColourPoint::*evidence) const {
    std::vector<Mark> marks;
    for (const ColourPoint& point : trace_.points)
      if (has_say(point))
        marks.push_back(
            {point.at, std::nullopt, is_dynamic(point, evidence) ? MarkKind::kRemoved : MarkKind::kKept});
    Layer judged = marked(name, frame_, std::move(marks));
    judged.words = {{MarkKind::kKept, "static"}, {MarkKind::kRemoved, "dynamic"}};
    return judged;
  }

  /// Each point's way against one reference, several times as long. @param ways px of the downsampled image
  [[nodiscard]] Layer ways_layer(const char* name, const ColourReference& reference,
                                 const std::vector<cv::Point2f>& ways, float longer) const {
    std::vector<Mark> marks;
    for (std::size_t k = 0; k < ways.size(); ++k) {
      const cv::Point2f at = trace_.points[static_cast<std::size_t>(reference.points[k])].at;
      // Lines are drawn at twice the way to where they come from.
      const float scale = 0.5F * longer * static_cast<float>(kSmallerBy);
      marks.push_back(
          {at, at - scale * ways[k], is_off(reference, k) ? MarkKind::kOutlier : MarkKind::kInlier});
    }
    return marked(name, frame_, std::move(marks));
  }

  void add_points() {
    Stage& points =
        log_.add("points", kPoints, "Points",
                 "Corners followed from frame to frame, forth and back; one a cell of the image.");
    points.ms = trace_.ms.points;
    const auto with_say = std::count_if(trace_.points.begin(), trace_.points.end(),
                                        [&](const ColourPoint& point) { return has_say(point); });
    std::vector<int> ages;
    for (const ColourPoint& point : trace_.points) ages.push_back(point.age);
    points.figure("Points", static_cast<double>(trace_.points.size()))
        .figure("Followed long enough", static_cast<double>(with_say))
        .figure("Median age", median_of(ages), "frames");
    points.add_side({frame_}, points_layer());
  }

  void add_reference(std::size_t index) {
    const ColourReference& reference = trace_.references[index];
    const std::string group = fmt::format("{} frame{} back", reference.gap, reference.gap == 1 ? "" : "s");
    const Layer shifts =
        ways_layer("Shifts beside the rotation, twice as long", reference, reference.shifts, 2.0F);
    Stage& turn = log_.add("camera_motion", group, "Camera's motion",
                           "The rotation and the direction of travel that explain where most points went.");
    turn.reference = static_cast<int>(index);
    turn.frames_back = reference.gap;
    turn.ms = reference.ms;
    const double cosine = 0.5 * (reference.motion.rotation.trace() - 1.0);
    turn.figure("Camera turned", std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / CV_PI, "°", 2)
        .figure("Points it explains", 100.0 * reference.motion.explained, "%", 1)
        .figure("Points seen in both", static_cast<double>(reference.points.size()));
    const Eigen::Vector3d& way = reference.motion.direction;
    turn.note = reference.motion.rotation_only
                    ? "The camera only turned: there is no parallax."
                    : fmt::format("The camera went elsewhere too, along ({:.2f}, {:.2f}, {:.2f}).", way.x(),
                                  way.y(), way.z());
    turn.add_side({points_layer()}, shifts);

    Stage& off = log_.add("epipolar_residual", group, "Epipolar residual",
                          "What lies off the epipolar line of the camera's motion: parallax goes along it.");
    off.reference = static_cast<int>(index);
    off.frames_back = reference.gap;
    off.timed = false;
    off.overview = index + 1 == trace_.references.size();
    double count = 0.0;
    for (std::size_t k = 0; k < reference.sigmas.size(); ++k) count += is_off(reference, k) ? 1.0 : 0.0;
    off.figure("Noise", kSmallerBy * reference.sigma, "px", 2)
        .figure("Above the limit", count)
        .figure("Of all", percent_of(count, reference.sigmas.size()), "%", 1);
    off.add_side({shifts},
                 ways_layer("Epipolar residuals, 8 times as long", reference, reference.residuals, 8.0F));
  }

  void add_evidence() {
    Layer shared = judged_layer("With their neighbours", &ColourPoint::shared);
    shared.id = "points";
    Stage& evidence =
        log_.add("point_evidence", kJudgement, "Evidence",
                 "Adds up the points' residuals, frame by frame, and smooths them over neighbours "
                 "that moved alike.");
    evidence.ms = trace_.ms.evidence;
    evidence.overview = true;
    evidence.figure("Points dynamic by themselves", count_dynamic(&ColourPoint::evidence))
        .figure("… with their neighbours", count_dynamic(&ColourPoint::shared));
    evidence.add_side({judged_layer("By themselves", &ColourPoint::evidence)}, shared);

    cv::Mat large;
    if (!trace_.evidence.empty())
      cv::resize(trace_.evidence, large, frame_.image.size(), 0, 0, cv::INTER_NEAREST);
    Layer spread_layer =
        signed_layer("Evidence", large, 1.0, "", FrameSpace::kTarget, config_.moving_evidence);
    spread_layer.id = "evidence";
    Stage& spread = log_.add("propagation", kJudgement, "Propagation",
                             "Each pixel takes the evidence of the point it reaches over the least change of "
                             "colour.");
    spread.ms = trace_.ms.spread;
    spread.overview = true;
    if (!trace_.evidence.empty())
      spread.figure("Above the limit", percent_above(trace_.evidence, config_.moving_evidence), "%", 2);
    spread.add_side({shared}, spread_layer);

    Stage& mask = log_.add("mask", kJudgement, "Mask",
                           "Gaps closed, small regions and those with few dynamic points dropped.");
    mask.ms = trace_.ms.mask;
    mask.overview = true;
    mask.figure("Mask", 100.0 * trace_.mask_share, "%", 2)
        .figure("Regions", static_cast<double>(trace_.regions.size()));
    mask.note = trace_.note;
    mask.add_side({spread_layer}, mask_layer("Mask", trace_.mask, frame_, "mask"));
  }

  const EpipolarTrace& trace_;
  const EpipolarConfig& config_;
  StageLog& log_;
  Layer frame_;
};

std::vector<std::string> explain_pixel(const EpipolarTrace& trace, const EpipolarConfig& config,
                                       const cv::Point2f& pixel, bool removed) {
  constexpr double kReach = 16.0;  // px: a point stands for what lies about it
  if (!removed) return {};
  const ColourPoint* near = nullptr;
  double nearest = kReach;
  for (const ColourPoint& point : trace.points)
    if (const double away = cv::norm(point.at - pixel); away <= nearest) nearest = away, near = &point;
  if (near == nullptr) return {"No followed point lies near it: evidence spread to it over like colours."};
  const bool by_itself = static_cast<double>(near->evidence) > config.moving_evidence;
  const bool with_others = static_cast<double>(near->shared) > config.moving_evidence;
  return {fmt::format("The point followed {:.0f} px away for {} frames {}.", nearest, near->age,
                      by_itself     ? "goes where the camera's own motion does not lead"
                      : with_others ? "is classified as dynamic by the neighbours that move as it does"
                                    : "is not dynamic: evidence spread here from others, over like colours")};
}

}  // namespace

StageLog describe_epipolar(const Frame& frame, const EpipolarTrace& trace, const EpipolarConfig& config) {
  StageLog log;
  log.note = trace.note;
  if (trace.points.empty()) return log;
  EpipolarStages(frame, trace, config, log).add_all();
  log.explain = [trace, config](const cv::Point2f& pixel, bool removed) {
    return explain_pixel(trace, config, pixel, removed);
  };
  return log;
}

}  // namespace stillpoint
