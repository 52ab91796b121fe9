#include "core/motion/shared_evidence.hpp"

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
                                               const ColourMotionConfig& config) {
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

}  // namespace

std::vector<float> share_evidence(const std::vector<PointTrack>& tracks, cv::Size small,
                                  const ColourMotionConfig& config) {
  const std::vector<std::vector<Link>> links = link_neighbours(tracks, small, config);
  std::vector<float> shared;
  for (const PointTrack& track : tracks) shared.push_back(track.evidence);
  const auto sharing = static_cast<float>(config.sharing);
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      // A point that is new has nothing of its own to say.
      const float own = tracks[i].age < config.min_age ? 1e-3F : 1.0F;
      float sum = own * tracks[i].evidence, weight = own;
      for (const Link& link : links[i]) {
        sum += sharing * link.weight * shared[static_cast<std::size_t>(link.to)];
        weight += sharing * link.weight;
      }
      shared[i] = sum / weight;
    }
  return shared;
}

cv::Mat spread_evidence(const cv::Mat& image, const std::vector<PointTrack>& tracks,
                        const std::vector<float>& shared, const ColourMotionConfig& config) {
  const int rows = image.rows, cols = image.cols, channels = image.channels();
  cv::Mat way(rows, cols, CV_32FC1, cv::Scalar(1e6)), value = cv::Mat::zeros(rows, cols, CV_32FC1);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].age < config.min_age) continue;
    const int x = std::clamp(static_cast<int>(tracks[i].path.back().x / 2), 0, cols - 1);
    const int y = std::clamp(static_cast<int>(tracks[i].path.back().y / 2), 0, rows - 1);
    way.at<float>(y, x) = 0.0F;
    value.at<float>(y, x) = shared[i];
  }
  const auto price = static_cast<float>(config.colour_price);
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
  constexpr float kDiagonal = 1.41421356F;
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
  value.setTo(0.0F, way > config.longest_way);
  return value;
}

}  // namespace stillpoint
