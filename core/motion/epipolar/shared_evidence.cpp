#include "core/motion/epipolar/shared_evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace stillpoint {
namespace {

constexpr int kSweeps = 15;     // Gauss-Seidel sweeps over the tracks
constexpr float kReach = 3.0F;  // neighbours lie within so many cells
constexpr int kPasses = 2;      // forth and back over the image

struct Link {
  int to;
  float weight;
};

/// How much two tracks' paths into the past, each from its own present place, differ at the most, px.
/// Negative where they share no past.
float largest_difference(const PointTrack& a, const PointTrack& b) {
  const std::size_t common = std::min(a.path.size(), b.path.size());
  if (common < 2) return -1.0F;
  float largest = 0.0F;
  const cv::Point2f apart = a.path.back() - b.path.back();
  for (std::size_t back = 1; back < common; ++back) {
    const cv::Point2f then = a.path[a.path.size() - 1 - back] - b.path[b.path.size() - 1 - back] - apart;
    largest = std::max(largest, then.dot(then));
  }
  return std::sqrt(largest);
}

std::vector<std::vector<Link>> link_neighbours(const std::vector<PointTrack>& tracks, cv::Size small,
                                               const EpipolarConfig& config) {
  const int cell = config.cell_px, across = small.width / cell + 1, down = small.height / cell + 1;
  std::vector<int> in_cell(static_cast<std::size_t>(across * down), -1);
  const auto place = [&](const PointTrack& track) {
    return cv::Point(static_cast<int>(track.path.back().x) / cell,
                     static_cast<int>(track.path.back().y) / cell);
  };
  for (std::size_t i = 0; i < tracks.size(); ++i)
    in_cell[static_cast<std::size_t>(place(tracks[i]).y * across + place(tracks[i]).x)] = static_cast<int>(i);
  std::vector<std::vector<Link>> links(tracks.size());
  const int reach = static_cast<int>(kReach);
  const float unit = static_cast<float>(cell);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const cv::Point at = place(tracks[i]);
    for (int y = std::max(0, at.y - reach); y <= std::min(down - 1, at.y + reach); ++y)
      for (int x = std::max(0, at.x - reach); x <= std::min(across - 1, at.x + reach); ++x) {
        const int j = in_cell[static_cast<std::size_t>(y * across + x)];
        if (j < 0 || j == static_cast<int>(i)) continue;
        const PointTrack& other = tracks[static_cast<std::size_t>(j)];
        const cv::Point2f apart = other.path.back() - tracks[i].path.back();
        const float distance = std::sqrt(apart.dot(apart)) / unit;
        if (distance > kReach) continue;
        const float difference = largest_difference(tracks[i], other);
        const auto same = static_cast<float>(config.same_motion_px) * (1.0F + 0.5F * distance);
        const float alike = difference < 0 ? 0.1F : std::exp(-(difference * difference) / (same * same));
        links[i].push_back({j, alike * std::exp(-0.25F * distance * distance)});
      }
  }
  return links;
}

/// What a point's own evidence counts against its neighbours'. One that is new has nothing of its own to say.
/// Off its line, a point has moved for sure; on it, it may move as well, and has been seen to are static
/// only after some time.
float own_weight(const PointTrack& track, const EpipolarConfig& config) {
  if (track.age < config.min_age) return 1e-3F;
  if (track.evidence >= 0.0F) return 1.0F;
  return std::min(1.0F, 2.0F * static_cast<float>(track.age) / static_cast<float>(config.far_reference));
}

/// From a moving point towards the side on which others move: a window that sees an outline moves with what
/// lies before, but its middle may lie beside it. None within what is dynamic; up to a cell at its outline.
cv::Point2f inward(const std::vector<PointTrack>& tracks, const std::vector<float>& shared, std::size_t point,
                   const EpipolarConfig& config) {
  const auto unit = static_cast<float>(config.cell_px);
  cv::Point2f sum;
  float all = 0.0F;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const cv::Point2f apart = tracks[i].path.back() - tracks[point].path.back();
    const float distance = std::sqrt(apart.dot(apart));
    if (i == point || distance > kReach * unit || distance < 1e-3F || tracks[i].age < config.min_age)
      continue;
    const float say = std::clamp(shared[i], -1.0F, 1.0F);
    sum += apart * (say / distance);
    all += std::abs(say);
  }
  return all > 0.0F ? sum * (unit / all) : cv::Point2f();
}

}  // namespace

std::vector<float> share_evidence(const std::vector<PointTrack>& tracks, cv::Size small,
                                  const EpipolarConfig& config) {
  const std::vector<std::vector<Link>> links = link_neighbours(tracks, small, config);
  std::vector<float> shared;
  for (const PointTrack& track : tracks) shared.push_back(track.evidence);
  const auto sharing = static_cast<float>(config.smoothing);
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      const float own = own_weight(tracks[i], config);
      float sum = own * tracks[i].evidence, weight = own;
      for (const Link& link : links[i]) {
        sum += sharing * link.weight * shared[static_cast<std::size_t>(link.to)];
        weight += sharing * link.weight;
      }
      shared[i] = sum / weight;
    }
  return shared;
}

PropagatedEvidence propagate_evidence(const cv::Mat& image, const std::vector<PointTrack>& tracks,
                                      const std::vector<float>& shared, const EpipolarConfig& config) {
  const int rows = image.rows, cols = image.cols, channels = image.channels();
  cv::Mat way(rows, cols, CV_32FC1, cv::Scalar(1e6)), value = cv::Mat::zeros(rows, cols, CV_32FC1);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].age < config.min_age) continue;
    cv::Point2f at = tracks[i].path.back();
    if (shared[i] > static_cast<float>(config.moving_evidence)) at += inward(tracks, shared, i, config);
    const int x = std::clamp(static_cast<int>(at.x / 2), 0, cols - 1);
    const int y = std::clamp(static_cast<int>(at.y / 2), 0, rows - 1);
    way.at<float>(y, x) = 0.0F;
    value.at<float>(y, x) = shared[i];
  }
  const auto price = static_cast<float>(config.colour_cost);
  const auto reach_from = [&](int y, int x, int v, int u, float length) {
    if (v < 0 || u < 0 || v >= rows || u >= cols) return;
    const std::uint8_t *here = image.ptr(y) + x * channels, *there = image.ptr(v) + u * channels;
    int change = 0;
    for (int c = 0; c < channels; ++c) change = std::max(change, std::abs(here[c] - there[c]));
    const float by = way.at<float>(v, u) + length * (1.0F + price * static_cast<float>(change));
    if (by < way.at<float>(y, x)) {
      way.at<float>(y, x) = by;
      value.at<float>(y, x) = value.at<float>(v, u);
    }
  };
  constexpr float kDiagonal = 1.41421356F;  // px: √2
  for (int pass = 0; pass < kPasses; ++pass) {
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < cols; ++x) {
        reach_from(y, x, y - 1, x - 1, kDiagonal);
        reach_from(y, x, y - 1, x, 1.0F);
        reach_from(y, x, y - 1, x + 1, kDiagonal);
        reach_from(y, x, y, x - 1, 1.0F);
      }
    for (int y = rows - 1; y >= 0; --y)
      for (int x = cols - 1; x >= 0; --x) {
        reach_from(y, x, y + 1, x + 1, kDiagonal);
        reach_from(y, x, y + 1, x, 1.0F);
        reach_from(y, x, y + 1, x - 1, kDiagonal);
        reach_from(y, x, y, x + 1, 1.0F);
      }
  }
  return {value, way};
}

}  // namespace stillpoint
