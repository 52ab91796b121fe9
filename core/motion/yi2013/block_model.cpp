#include "core/motion/yi2013/block_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace stillpoint {

Yi2013Blocks yi2013_blocks(const cv::Mat& gray, int block_px) {
  const int columns = gray.cols / block_px, rows = gray.rows / block_px, width = columns * block_px;
  Yi2013Blocks blocks{cv::Mat(rows, columns, CV_32FC1), cv::Mat(rows, columns, CV_8UC1),
                      cv::Mat(rows, columns, CV_8UC1)};
  // Down the columns of a row of blocks first: neighbouring pixels go through the same steps at once.
  std::vector<std::uint16_t> sums(static_cast<std::size_t>(width));
  std::vector<std::uint8_t> lows(sums.size()), highs(sums.size());
  std::uint16_t* const sum = sums.data();
  std::uint8_t *const low = lows.data(), *const high = highs.data();
  const float share = 1.0F / static_cast<float>(block_px * block_px);
  for (int by = 0; by < rows; ++by) {
    std::fill(sums.begin(), sums.end(), std::uint16_t{0});
    std::fill(lows.begin(), lows.end(), std::uint8_t{255});
    std::fill(highs.begin(), highs.end(), std::uint8_t{0});
    for (int y = by * block_px; y < (by + 1) * block_px; ++y) {
      const auto* row = gray.ptr<std::uint8_t>(y);
      for (int x = 0; x < width; ++x) {
        sum[x] = static_cast<std::uint16_t>(sum[x] + row[x]);
        low[x] = low[x] < row[x] ? low[x] : row[x];
        high[x] = high[x] > row[x] ? high[x] : row[x];
      }
    }
    auto* mean = blocks.mean.ptr<float>(by);
    auto *least = blocks.least.ptr<std::uint8_t>(by), *most = blocks.most.ptr<std::uint8_t>(by);
    for (int bx = 0; bx < columns; ++bx) {
      int total = 0;
      std::uint8_t l = 255, m = 0;
      for (int x = bx * block_px; x < (bx + 1) * block_px; ++x) {
        total += sum[x];
        l = l < low[x] ? l : low[x];
        m = m > high[x] ? m : high[x];
      }
      mean[bx] = share * static_cast<float>(total);
      least[bx] = l;
      most[bx] = m;
    }
  }
  return blocks;
}

namespace {

Yi2013Gaussians gaussians(const cv::Size& size) {
  return {cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1)};
}

/// Where a block's centre was in the last frame's blocks, and its shares in the four about that place: the
/// block it lies in, and the neighbours to the side, above or below, and across.
struct OldPlace {
  bool interior = false;  ///< two blocks or more from every side: all four are there
  int count = 0;          ///< of those that are there
  std::array<int, 4> at{};
  std::array<float, 4> share{};  ///< sum 1
};

OldPlace old_place(const RasterPoint& middle, const cv::Size& size) {
  OldPlace place;
  const double u = middle.px().x(), v = middle.px().y();
  // Also false for NaN, as of a place behind the camera.
  if (!(u > -1.0 && v > -1.0 && u < size.width + 1.0 && v < size.height + 1.0)) return place;
  const int bx = static_cast<int>(u + 1.0) - 1, by = static_cast<int>(v + 1.0) - 1;
  const double dx = u - bx - 0.5, dy = v - by - 0.5;  // from that block's own middle
  const int nx = bx + (dx < 0.0 ? -1 : 1), ny = by + (dy < 0.0 ? -1 : 1);
  const double ax = std::abs(dx), ay = std::abs(dy);
  place.interior = bx >= 1 && by >= 1 && bx < size.width - 1 && by < size.height - 1;
  double sum = 0.0;
  const auto add = [&](int x, int y, double share) {
    if (share <= 0.0 || x < 0 || y < 0 || x >= size.width || y >= size.height) return;
    place.at[static_cast<std::size_t>(place.count)] = y * size.width + x;
    place.share[static_cast<std::size_t>(place.count++)] = static_cast<float>(share);
    sum += share;
  };
  add(bx, by, (1.0 - ax) * (1.0 - ay));
  add(nx, by, ax * (1.0 - ay));
  add(bx, ny, (1.0 - ax) * ay);
  add(nx, ny, ax * ay);
  for (int k = 0; k < place.count; ++k) {
    float& share = place.share[static_cast<std::size_t>(k)];
    share = static_cast<float>(share / sum);
  }
  return place;
}

}  // namespace

Yi2013Places yi2013_places(const cv::Size& size, const cv::Matx33d& last_from_here, int block_px) {
  Yi2013Places places;
  places.reserve(static_cast<std::size_t>(size.area()));
  const double side = block_px;
  // The homography is of pixel coordinates, half a pixel aside: a turn of 1° about the optical axis makes
  // 0.01 px of that.
  const cv::Matx33d& h = last_from_here;
  for (int by = 0; by < size.height; ++by) {
    const double y = (to_raster(static_cast<double>(by)) * side).px();
    for (int bx = 0; bx < size.width; ++bx) {
      const double x = (to_raster(static_cast<double>(bx)) * side).px();
      const double depth = h(2, 0) * x + h(2, 1) * y + h(2, 2);
      const double scale = depth > 0.0 ? 1.0 / (depth * side) : std::numeric_limits<double>::quiet_NaN();
      places.emplace_back(scale * (h(0, 0) * x + h(0, 1) * y + h(0, 2)),
                          scale * (h(1, 0) * x + h(1, 1) * y + h(1, 2)));
    }
  }
  return places;
}

Yi2013Model yi2013_warped(const Yi2013Model& last, const cv::Matx33d& last_from_here,
                          const Yi2013Blocks& blocks, const Yi2013Config& config) {
  const bool begins = last[0].mean.size() != blocks.mean.size();
  return yi2013_warped(
      last, begins ? Yi2013Places() : yi2013_places(blocks.mean.size(), last_from_here, config.block_px),
      blocks, config);
}

Yi2013Model yi2013_warped(const Yi2013Model& last, const Yi2013Places& places, const Yi2013Blocks& blocks,
                          const Yi2013Config& config) {
  const cv::Size size = blocks.mean.size();
  Yi2013Model warped{gaussians(size), gaussians(size)};
  const bool begins = last[0].mean.size() != size;
  const auto initial = static_cast<float>(config.initial_sigma * config.initial_sigma);
  const auto least = static_cast<float>(config.least_sigma * config.least_sigma);
  const auto calm = static_cast<float>(config.decay_above_sigma * config.decay_above_sigma);
  const auto decay = static_cast<float>(config.decay), oldest = static_cast<float>(config.max_age);
  for (int by = 0; by < size.height; ++by) {
    const auto* seen = blocks.mean.ptr<float>(by);
    for (int bx = 0; bx < size.width; ++bx) {
      OldPlace place;
      if (!begins) {
        place = old_place(places[static_cast<std::size_t>(by * size.width + bx)], size);
      }
      for (std::size_t mode = 0; mode < 2; ++mode) {
        const auto *means = last[mode].mean.ptr<float>(), *variances = last[mode].variance.ptr<float>(),
                   *ages = last[mode].age.ptr<float>();
        float mean = 0.0F, variance = 0.0F, age = 0.0F, youngest = 0.0F, eldest = 0.0F;
        const auto count = static_cast<std::size_t>(place.count);
        for (std::size_t k = 0; k < count; ++k) {
          const float old = ages[place.at[k]];
          mean += place.share[k] * means[place.at[k]];
          age += place.share[k] * old;
          youngest = k == 0 ? old : std::min(youngest, old);
          eldest = std::max(eldest, old);
        }
        // Rounded shares may add up to more than one, and an age of just above one would judge.
        age = std::max(youngest, std::min(age, eldest));
        for (std::size_t k = 0; k < count; ++k) {
          const float off = means[place.at[k]] - mean;
          variance += place.share[k] * (variances[place.at[k]] + off * off);
        }
        variance = std::max(variance, least);
        if (!place.interior) variance = initial, age = 0.0F;
        if (count == 0) mean = seen[bx];
        if (variance > calm) age *= std::exp(-decay * (variance - calm));
        warped[mode].mean.ptr<float>(by)[bx] = mean;
        warped[mode].variance.ptr<float>(by)[bx] = variance;
        warped[mode].age.ptr<float>(by)[bx] = std::min(age, oldest);
      }
    }
  }
  return warped;
}

cv::Mat yi2013_choose(Yi2013Model& warped, const Yi2013Blocks& blocks, const Yi2013Config& config) {
  cv::Mat matches(blocks.mean.size(), CV_8UC1);
  const auto initial = static_cast<float>(config.initial_sigma * config.initial_sigma);
  const auto limit = static_cast<float>(config.match_limit);
  for (int by = 0; by < matches.rows; ++by) {
    const auto* seen = blocks.mean.ptr<float>(by);
    auto *mean0 = warped[0].mean.ptr<float>(by), *mean1 = warped[1].mean.ptr<float>(by);
    auto *variance0 = warped[0].variance.ptr<float>(by), *variance1 = warped[1].variance.ptr<float>(by);
    auto *age0 = warped[0].age.ptr<float>(by), *age1 = warped[1].age.ptr<float>(by);
    auto* match = matches.ptr<std::uint8_t>(by);
    for (int bx = 0; bx < matches.cols; ++bx) {
      if (age1[bx] >= age0[bx]) {  // ties too: so the first frame begins
        mean0[bx] = mean1[bx], variance0[bx] = variance1[bx], age0[bx] = age1[bx];
        mean1[bx] = seen[bx], variance1[bx] = initial, age1[bx] = 0.0F;
      }
      const float off0 = seen[bx] - mean0[bx], off1 = seen[bx] - mean1[bx];
      if (off0 * off0 < limit * variance0[bx]) {
        match[bx] = kMatchApparent;
      } else if (off1 * off1 < limit * variance1[bx]) {
        match[bx] = kMatchCandidate;
      } else {
        match[bx] = kMatchNeither;
        age1[bx] = 0.0F;
      }
    }
  }
  return matches;
}

Yi2013Model yi2013_updated(const Yi2013Model& chosen, const cv::Mat& matches, const Yi2013Blocks& blocks,
                           const Yi2013Config& config) {
  Yi2013Model updated;
  for (std::size_t mode = 0; mode < 2; ++mode)
    updated[mode] = {chosen[mode].mean.clone(), chosen[mode].variance.clone(), chosen[mode].age.clone()};
  const auto initial = static_cast<float>(config.initial_sigma * config.initial_sigma);
  const auto lowest = static_cast<float>(config.least_sigma * config.least_sigma);
  const auto oldest = static_cast<float>(config.max_age);
  for (int by = 0; by < matches.rows; ++by) {
    const auto* seen = blocks.mean.ptr<float>(by);
    const auto *least = blocks.least.ptr<std::uint8_t>(by), *most = blocks.most.ptr<std::uint8_t>(by);
    const auto* match = matches.ptr<std::uint8_t>(by);
    float *means[2], *variances[2], *ages[2];
    for (std::size_t mode = 0; mode < 2; ++mode) {
      means[mode] = updated[mode].mean.ptr<float>(by);
      variances[mode] = updated[mode].variance.ptr<float>(by);
      ages[mode] = updated[mode].age.ptr<float>(by);
    }
    for (int bx = 0; bx < matches.cols; ++bx) {
      const int mode = match[bx] == kMatchApparent ? 0 : 1;
      const float age = ages[mode][bx], kept = age / (age + 1.0F);
      const float mean = age < 1.0F ? seen[bx] : kept * means[mode][bx] + (1.0F - kept) * seen[bx];
      // The block's farthest pixel is its darkest or its brightest.
      const float down = mean - static_cast<float>(least[bx]), up = static_cast<float>(most[bx]) - mean;
      const float farthest = std::max(down * down, up * up);
      const float variance =
          age > 0.0F ? kept * variances[mode][bx] + (1.0F - kept) * farthest : std::max(farthest, initial);
      means[mode][bx] = mean;
      variances[mode][bx] = std::max(variance, lowest);
      ages[mode][bx] = std::min(age + 1.0F, oldest);
    }
  }
  return updated;
}

cv::Mat yi2013_moving(const cv::Mat& gray, const Yi2013Model& chosen, const Yi2013Model& updated,
                      const Yi2013Config& config) {
  cv::Mat mask(gray.size(), CV_8UC1, cv::Scalar(0));
  const int side = config.block_px, columns = chosen[0].mean.cols, width = columns * side;
  std::vector<float> means(static_cast<std::size_t>(width)), limits(means.size());
  const float *const mean = means.data(), *const limit = limits.data();
  const auto factor = static_cast<float>(config.moving_limit), young = static_cast<float>(config.settled_age);
  for (int by = 0; by < chosen[0].mean.rows; ++by) {
    const auto* block_mean = updated[0].mean.ptr<float>(by);
    const auto *variance = chosen[0].variance.ptr<float>(by), *age = chosen[0].age.ptr<float>(by);
    for (int x = 0; x < width; ++x) {
      means[static_cast<std::size_t>(x)] = block_mean[x / side];
      limits[static_cast<std::size_t>(x)] =
          age[x / side] > young ? factor * variance[x / side] : std::numeric_limits<float>::max();
    }
    for (int y = by * side; y < (by + 1) * side; ++y) {
      const auto* row = gray.ptr<std::uint8_t>(y);
      auto* moving = mask.ptr<std::uint8_t>(y);
      for (int x = 0; x < width; ++x) {
        const float off = static_cast<float>(row[x]) - mean[x];
        moving[x] = off * off > limit[x] ? 255 : 0;
      }
    }
  }
  return mask;
}

}  // namespace stillpoint
