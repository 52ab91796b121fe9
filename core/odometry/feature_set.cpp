#include "core/odometry/feature_set.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace stillpoint {

void FeatureSet::build_index(int width, int height) {
  columns_ = width / kCell + 1;
  rows_ = height / kCell + 1;
  place();
}

void FeatureSet::place() {
  const auto cell_of = [&](const cv::Point2f& p) {
    // Undistorted pixels may lie outside the image: the outermost cells take them.
    const int column = std::clamp(static_cast<int>(std::floor(p.x / kCell)), 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(std::floor(p.y / kCell)), 0, rows_ - 1);
    return static_cast<std::size_t>(row * columns_ + column);
  };
  cell_start_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
  for (const auto& p : undistorted) ++cell_start_[cell_of(p) + 1];
  for (std::size_t c = 1; c < cell_start_.size(); ++c) cell_start_[c] += cell_start_[c - 1];
  placed_.resize(undistorted.size());
  std::vector<int> next(cell_start_.begin(), cell_start_.end() - 1);
  for (std::size_t i = 0; i < undistorted.size(); ++i)
    placed_[static_cast<std::size_t>(next[cell_of(undistorted[i])]++)] = {undistorted[i], keypoints[i].octave,
                                                                          static_cast<int>(i)};
}

void FeatureSet::find(const cv::Point2f& pixel, float radius, int min_octave, int max_octave,
                      std::vector<int>& found) const {
  if (columns_ == 0) return;
  const auto column = [&](float x) {
    return std::clamp(static_cast<int>(std::floor(x / kCell)), 0, columns_ - 1);
  };
  const auto row = [&](float y) { return std::clamp(static_cast<int>(std::floor(y / kCell)), 0, rows_ - 1); };
  const int first_column = column(pixel.x - radius), last_column = column(pixel.x + radius);
  for (int r = row(pixel.y - radius); r <= row(pixel.y + radius); ++r) {
    const auto first_cell = static_cast<std::size_t>(r * columns_ + first_column);
    const auto last_cell = static_cast<std::size_t>(r * columns_ + last_column);
    const int first = cell_start_[first_cell], end = cell_start_[last_cell + 1];
    // Which are inside is as good as chance, and no branch foretells it: all are written, and those that are
    // not inside written over.
    std::size_t count = found.size();
    found.resize(count + static_cast<std::size_t>(end - first) + 1);
    for (int k = first; k < end; ++k) {
      const Placed& placed = placed_[static_cast<std::size_t>(k)];
      const cv::Point2f d = placed.pixel - pixel;
      found[count] = placed.feature;
      count += (placed.octave >= min_octave) & (placed.octave <= max_octave) & (std::abs(d.x) <= radius) &
               (std::abs(d.y) <= radius);
    }
    found.resize(count);
  }
}

std::vector<std::uint8_t> FeatureSet::packed() const {
  std::vector<std::uint8_t> bytes;
  const auto append = [&bytes](const void* from, std::size_t count) {
    const auto* first = static_cast<const std::uint8_t*>(from);
    bytes.insert(bytes.end(), first, first + count);
  };
  const auto append_all = [&append]<typename T>(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t count = values.size();
    append(&count, sizeof(count));
    append(values.data(), count * sizeof(T));
  };
  append(&columns_, sizeof(columns_));
  append(&rows_, sizeof(rows_));
  append_all(keypoints);
  append_all(undistorted);
  append_all(descriptors);
  append_all(depth);
  append_all(static_weight);
  return bytes;
}

FeatureSet FeatureSet::unpacked(const std::vector<std::uint8_t>& bytes) {
  const std::uint8_t* at = bytes.data();
  const auto take = [&at](void* to, std::size_t count) {
    if (count > 0) std::memcpy(to, at, count);
    at += count;
  };
  const auto take_all = [&take]<typename T>(std::vector<T>& values) {
    std::size_t count = 0;
    take(&count, sizeof(count));
    values.resize(count);
    take(values.data(), count * sizeof(T));
  };
  FeatureSet set;
  take(&set.columns_, sizeof(set.columns_));
  take(&set.rows_, sizeof(set.rows_));
  take_all(set.keypoints);
  take_all(set.undistorted);
  take_all(set.descriptors);
  take_all(set.depth);
  take_all(set.static_weight);
  // One that was never placed has no cells.
  if (set.columns_ > 0) set.place();
  return set;
}

FeatureSet subset(const FeatureSet& all, const std::vector<std::uint8_t>& keep, int width, int height) {
  FeatureSet kept;
  const auto count =
      static_cast<std::size_t>(std::count_if(keep.begin(), keep.end(), [](auto k) { return k != 0; }));
  kept.keypoints.reserve(count);
  kept.undistorted.reserve(count);
  kept.descriptors.reserve(count);
  kept.depth.reserve(count);
  kept.static_weight.reserve(count);
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (!keep[i]) continue;
    kept.keypoints.push_back(all.keypoints[i]);
    kept.undistorted.push_back(all.undistorted[i]);
    kept.descriptors.push_back(all.descriptors[i]);
    kept.depth.push_back(all.depth[i]);
    kept.static_weight.push_back(all.static_weight[i]);
  }
  kept.build_index(width, height);
  return kept;
}

std::vector<float> depth_at(const std::vector<cv::Point2f>& pixels, const cv::Mat& depth) {
  std::vector<float> result(pixels.size(), 0.0F);
  if (depth.empty()) return result;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const int x = cvRound(pixels[i].x), y = cvRound(pixels[i].y);
    if (x < 0 || y < 0 || x >= depth.cols || y >= depth.rows) continue;
    const float z = depth.at<float>(y, x);
    if (std::isfinite(z) && z > 0) result[i] = z;
  }
  return result;
}

std::vector<float> depth_at(const std::vector<cv::Point2f>& pixels,
                            const std::vector<cv::Point2f>& undistorted, const cv::Mat& depth,
                            const Camera& camera, const Vector6d& velocity, std::optional<double> lag_s) {
  std::vector<float> result = depth_at(pixels, depth);
  if (depth.empty() || !lag_s || !camera.depth_is_late(*lag_s)) return result;
  // The whole image's lag exactly, what a row's differs from it to first order: that is some milliseconds.
  const double middle_lag = camera.depth_lag(*lag_s, camera.middle_row());
  const Pose then_from_now = se3_exp(velocity * middle_lag), now_from_then = then_from_now.inverse();
  const auto rowed = [&](std::size_t i, const Eigen::Vector3d& p, double sign) -> Eigen::Vector3d {
    if (!camera.depth_readout_s) return p;
    const double more = camera.depth_lag(*lag_s, static_cast<double>(pixels[i].y)) - middle_lag;
    return p + sign * more * (velocity.head<3>() + velocity.tail<3>().cross(p));
  };
  // The first reading is near enough to tell where the point was seen then; distortion is the same over so
  // few pixels.
  std::vector<cv::Point2f> then(pixels);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (result[i] <= 0) continue;
    const Eigen::Vector2d now(undistorted[i].x, undistorted[i].y);
    const Eigen::Vector3d p = rowed(i, then_from_now * camera.back_project(now, result[i]), 1.0);
    if (p.z() <= 0) continue;
    const Eigen::Vector2d shift = camera.project(p) - now;
    then[i] += cv::Point2f(static_cast<float>(shift.x()), static_cast<float>(shift.y()));
  }
  const std::vector<float> measured = depth_at(then, depth);
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    if (result[i] <= 0) continue;
    const cv::Point2f pixel = undistorted[i] + then[i] - pixels[i];
    const Eigen::Vector3d then_measured = camera.back_project({pixel.x, pixel.y}, measured[i]);
    const double z = measured[i] > 0 ? (now_from_then * rowed(i, then_measured, -1.0)).z() : 0.0;
    result[i] = z > 0 ? static_cast<float>(z) : 0.0F;
  }
  return result;
}

}  // namespace stillpoint
