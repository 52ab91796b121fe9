#include "core/odometry/matching.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace stillpoint {
namespace {

/// The best and second-best features of one candidate so far.
struct Best {
  int feature = kNone, distance = 257, octave = 0;
  int second_distance = 257, second_octave = 0;

  void offer(int index, int candidate_distance, int candidate_octave) {
    if (candidate_distance < distance) {
      second_distance = distance, second_octave = octave;
      feature = index, distance = candidate_distance, octave = candidate_octave;
    } else if (candidate_distance < second_distance) {
      second_distance = candidate_distance, second_octave = candidate_octave;
    }
  }

  [[nodiscard]] bool ambiguous(double ratio, bool any_octave) const {
    return second_distance <= 256 && (any_octave || octave == second_octave) &&
           distance > ratio * second_distance;
  }
};

/// Collects matches so that each feature goes to the candidate nearest to it.
class Assignment {
 public:
  explicit Assignment(const FeatureSet& features) : features_(features), best_(features.keypoints.size()) {}

  void claim(const Candidate& candidate, const Best& best) {
    Match& match = best_[static_cast<std::size_t>(best.feature)];
    if (match.point != kNone && match.distance <= best.distance) return;
    const float now = features_.keypoints[static_cast<std::size_t>(best.feature)].angle;
    float turned = candidate.angle < 0 ? 0.0F : now - candidate.angle;
    if (turned < 0) turned += 360.0F;
    match = {best.feature, candidate.point, best.distance, turned};
  }

  [[nodiscard]] std::vector<Match> matches() const {
    std::vector<Match> result;
    result.reserve(best_.size());
    std::copy_if(best_.begin(), best_.end(), std::back_inserter(result),
                 [](const Match& m) { return m.point != kNone; });
    return result;
  }

 private:
  const FeatureSet& features_;
  std::vector<Match> best_;
};

}  // namespace

std::vector<Match> match_in_windows(const FeatureSet& features, const std::vector<Candidate>& candidates,
                                    int max_distance, double ratio) {
  Assignment assignment(features);
  std::vector<int> near;
  for (const Candidate& candidate : candidates) {
    near.clear();
    features.find(candidate.pixel, candidate.radius, candidate.min_octave, candidate.max_octave, near);
    Best best;
    for (const int i : near) {
      const auto f = static_cast<std::size_t>(i);
      best.offer(i, descriptor_distance(*candidate.descriptor, features.descriptors[f]),
                 features.keypoints[f].octave);
    }
    if (best.feature != kNone && best.distance <= max_distance && !best.ambiguous(ratio, false))
      assignment.claim(candidate, best);
  }
  return assignment.matches();
}

std::vector<Match> match_everywhere(const FeatureSet& features, const std::vector<Candidate>& candidates,
                                    int max_distance, double ratio) {
  Assignment assignment(features);
  for (const Candidate& candidate : candidates) {
    Best best;
    for (int i = 0; i < features.size(); ++i) {
      const auto f = static_cast<std::size_t>(i);
      best.offer(i, descriptor_distance(*candidate.descriptor, features.descriptors[f]),
                 features.keypoints[f].octave);
    }
    if (best.feature != kNone && best.distance <= max_distance && !best.ambiguous(ratio, true))
      assignment.claim(candidate, best);
  }
  return assignment.matches();
}

std::vector<Match> consistently_turned(const std::vector<Match>& matches) {
  constexpr int kBins = 30;  // of 12° each, as ORB-SLAM has it
  const auto bin = [](const Match& m) {
    return static_cast<std::size_t>(cvRound(m.turned * kBins / 360.0F) % kBins);
  };
  std::array<int, kBins> counts{};
  for (const Match& m : matches) ++counts[bin(m)];
  std::array<std::size_t, kBins> order{};
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
  std::array<bool, kBins> keep{};
  for (int rank = 0; rank < 3; ++rank) {
    const std::size_t b = order[static_cast<std::size_t>(rank)];
    // A bin far below the fullest holds chance agreement only.
    keep[b] = counts[b] * 10 >= counts[order[0]];
  }
  std::vector<Match> kept;
  kept.reserve(matches.size());
  std::copy_if(matches.begin(), matches.end(), std::back_inserter(kept),
               [&](const Match& m) { return keep[bin(m)]; });
  return kept;
}

Projection project_point(const MapPoint& point, const Camera& camera, const Pose& camera_from_world,
                         const FeatureConfig& config) {
  constexpr double kMaxViewingAngleCosine =
      0.5;  // 60 degrees off the mean direction a patch is not recognised
  Projection result;
  const Eigen::Vector3d p = camera_from_world * point.position;
  if (p.z() < 0.05) return result;
  const Eigen::Vector2d pixel = camera.project(p);
  if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= camera.width || pixel.y() >= camera.height)
    return result;
  result.distance = p.norm();
  // The pyramid's ends reach a little beyond: the octave is only a guess to within one.
  if (result.distance < 0.8 * point.min_distance || result.distance > 1.2 * point.max_distance) return result;
  const Eigen::Vector3d direction = camera_from_world.linear().transpose() * p / result.distance;
  if (direction.dot(point.viewing_direction) < kMaxViewingAngleCosine) return result;
  result.pixel = {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
  const double octave =
      std::ceil(std::log(point.max_distance / result.distance) / std::log(config.scale_factor));
  result.octave = std::clamp(static_cast<int>(octave), 0, config.levels - 1);
  result.visible = true;
  return result;
}

std::vector<double> octave_scales(const FeatureConfig& config) {
  std::vector<double> scales(static_cast<std::size_t>(config.levels), 1.0);
  for (std::size_t i = 1; i < scales.size(); ++i) scales[i] = scales[i - 1] * config.scale_factor;
  return scales;
}

}  // namespace stillpoint
