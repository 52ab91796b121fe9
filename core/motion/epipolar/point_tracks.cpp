#include "core/motion/epipolar/point_tracks.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "core/geometry/pixel_conventions.hpp"

namespace stillpoint {
namespace {

constexpr int kMargin = 4;          // px, downsampled image: closer to the border windows have no data
constexpr int kLevels = 2;          // pyramid levels above the downsampled image
constexpr int kBackLevels = 1;      // … on the way back, which starts where it should end
constexpr float kMaxReturn = 0.5F;  // px: forth and back must end where it began

constexpr int kCoarseLevel = 2;  // of the pyramid, at which parts of the picture are aligned first
constexpr int kCoarseCell = 8, kCoarseWindow = 15;  // px at that level

constexpr std::size_t kNeighbours = 8;  // points: their median is no outlier while half of them are right
constexpr float kMaxJump = 4.5F;        // px a frame: larger changes of velocity are slips

// At most 12 steps, or one of 0.02 px, which is well below a followed point's noise.
const cv::TermCriteria kStop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 12, 0.02);
// Grey levels² as OpenCV scales them, and its default: below, a window has no texture.
constexpr double kMinEigen = 1e-4;

int cells_across(int pixels, int cell) { return (pixels + cell - 1) / cell; }

std::size_t cell_of(const cv::Point2f& point, int cell, cv::Size size) {
  const int x = static_cast<int>(point.x) / cell, y = static_cast<int>(point.y) / cell;
  return static_cast<std::size_t>(y * cells_across(size.width, cell) + x);
}

bool inside(const cv::Point2f& point, cv::Size size) {
  return point.x >= kMargin && point.y >= kMargin && point.x < static_cast<float>(size.width - kMargin) &&
         point.y < static_cast<float>(size.height - kMargin);
}

/// How each part of the picture has shifted, px of the pyramid's first level: where points are looked for
/// first, for what repeats or is blurred is else taken for its neighbour. CV_32FC2, a cell a value.
cv::Mat coarse_shifts(const std::vector<cv::Mat>& from, const std::vector<cv::Mat>& to) {
  const cv::Mat a = from[2 * kCoarseLevel].clone(), b = to[2 * kCoarseLevel].clone();
  const int across = a.cols / kCoarseCell, down = a.rows / kCoarseCell;
  // Cells' middles to half a pixel: their raster coordinates, which are followed as pixels.
  std::vector<cv::Point2f> places, ends;
  for (int y = 0; y < down; ++y)
    for (int x = 0; x < across; ++x)
      places.emplace_back((to_raster(static_cast<float>(x)) * kCoarseCell).px(),
                          (to_raster(static_cast<float>(y)) * kCoarseCell).px());
  std::vector<std::uint8_t> found;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(a, b, places, ends, found, error, {kCoarseWindow, kCoarseWindow}, 2, kStop);
  cv::Mat shifts(down, across, CV_32FC2, cv::Scalar::all(0));
  std::vector<float> dx, dy;
  for (int y = 0; y < down; ++y)
    for (int x = 0; x < across; ++x) {
      dx.clear(), dy.clear();
      for (int v = std::max(0, y - 1); v <= std::min(down - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(across - 1, x + 1); ++u)
          if (const auto i = static_cast<std::size_t>(v * across + u); found[i] != 0) {
            dx.push_back(ends[i].x - places[i].x);
            dy.push_back(ends[i].y - places[i].y);
          }
      if (dx.empty()) continue;
      const auto middle = static_cast<std::ptrdiff_t>(dx.size() / 2);
      std::nth_element(dx.begin(), dx.begin() + middle, dx.end());
      std::nth_element(dy.begin(), dy.begin() + middle, dy.end());
      shifts.at<cv::Vec2f>(y, x) =
          static_cast<float>(1 << kCoarseLevel) * cv::Vec2f(dx[dx.size() / 2], dy[dy.size() / 2]);
    }
  return shifts;
}

/// Points whose velocity jumps within a frame as their neighbours' does not: they have slipped to the next of
/// what repeats, as the keys of a keyboard do.
std::vector<std::uint8_t> find_slips(const std::vector<PointTrack>& tracks,
                                     const std::vector<cv::Point2f>& to,
                                     const std::vector<std::uint8_t>& found) {
  struct Change {
    std::size_t track;
    cv::Point2f at, velocity;
  };
  std::vector<Change> changes;
  for (std::size_t i = 0; i < tracks.size(); ++i)
    if (const cv::Point2f* before = tracks[i].back(1); found[i] != 0 && before) {
      const cv::Point2f now = tracks[i].path.back();
      changes.push_back({i, now, to[i] - now - (now - *before)});
    }
  std::vector<std::uint8_t> slipped(tracks.size(), 0);
  if (changes.size() <= kNeighbours) return slipped;
  for (const Change& change : changes) {
    std::array<std::pair<float, std::size_t>, kNeighbours + 1> nearest;
    nearest.fill({std::numeric_limits<float>::max(), 0});
    for (std::size_t j = 0; j < changes.size(); ++j) {
      const cv::Point2f apart = changes[j].at - change.at;
      const float distance = apart.dot(apart);
      if (distance >= nearest.back().first) continue;
      std::size_t place = kNeighbours;
      for (; place > 0 && nearest[place - 1].first > distance; --place) nearest[place] = nearest[place - 1];
      nearest[place] = {distance, j};
    }
    std::array<float, kNeighbours + 1> dx{}, dy{};  // its own among them
    for (std::size_t k = 0; k <= kNeighbours; ++k) {
      dx[k] = changes[nearest[k].second].velocity.x;
      dy[k] = changes[nearest[k].second].velocity.y;
    }
    std::nth_element(dx.begin(), dx.begin() + kNeighbours / 2, dx.end());
    std::nth_element(dy.begin(), dy.begin() + kNeighbours / 2, dy.end());
    const cv::Point2f jump = change.velocity - cv::Point2f(dx[kNeighbours / 2], dy[kNeighbours / 2]);
    slipped[change.track] = jump.dot(jump) > kMaxJump * kMaxJump ? 1 : 0;
  }
  return slipped;
}

}  // namespace

void PointTracks::clear() {
  tracks_.clear();
  pyramid_.clear();
  frames_ = 0;
}

void PointTracks::follow(const std::vector<cv::Mat>& pyramid, const EpipolarConfig& config) {
  if (tracks_.empty()) return;
  std::vector<cv::Point2f> from, to, back;
  const cv::Mat shifts = coarse_shifts(pyramid_, pyramid);
  constexpr float kCell = static_cast<float>(kCoarseCell << kCoarseLevel);
  for (const PointTrack& track : tracks_) {
    const cv::Point2f at = track.path.back();
    const auto shift = shifts.at<cv::Vec2f>(std::min(static_cast<int>(at.y / kCell), shifts.rows - 1),
                                            std::min(static_cast<int>(at.x / kCell), shifts.cols - 1));
    from.push_back(at);
    to.emplace_back(at.x + shift[0], at.y + shift[1]);
  }
  std::vector<std::uint8_t> found, returned;
  std::vector<float> error;
  const cv::Size window(config.flow_window_px, config.flow_window_px);
  cv::calcOpticalFlowPyrLK(pyramid_, pyramid, from, to, found, error, window, kLevels, kStop,
                           cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigen);
  back = from;
  cv::calcOpticalFlowPyrLK(pyramid, pyramid_, to, back, returned, error, window, kBackLevels, kStop,
                           cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigen);
  const cv::Size size = pyramid[0].size();
  const std::size_t kept_positions = static_cast<std::size_t>(config.far_reference) + 1;
  const std::vector<std::uint8_t> slipped = find_slips(tracks_, to, found);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const cv::Point2f off = back[i] - from[i];
    if (!found[i] || !returned[i] || !inside(to[i], size) || off.dot(off) > kMaxReturn * kMaxReturn) continue;
    if (slipped[i]) continue;
    PointTrack track = std::move(tracks_[i]);
    if (track.path.size() == kept_positions) track.path.erase(track.path.begin());
    track.path.push_back(to[i]);
    ++track.age;
    tracks_[kept++] = std::move(track);
  }
  tracks_.resize(kept);
}

void PointTracks::thin_out(cv::Size size, int cell, std::vector<std::uint8_t>& taken) {
  std::vector<std::size_t> order(tracks_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [this](std::size_t a, std::size_t b) { return tracks_[a].age > tracks_[b].age; });
  std::vector<std::uint8_t> keep(tracks_.size(), 0);
  for (const std::size_t i : order) {
    std::uint8_t& here = taken[cell_of(tracks_[i].path.back(), cell, size)];
    if (here != 0) continue;
    here = 1;
    keep[i] = 1;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    if (keep[i] != 0) {
      if (kept != i) tracks_[kept] = std::move(tracks_[i]);
      ++kept;
    }
  tracks_.resize(kept);
}

void PointTracks::plant(const cv::Mat& small, int cell, double quality, std::vector<std::uint8_t>& taken) {
  cv::Mat response;
  cv::cornerMinEigenVal(small, response, 5, 3);
  const int across = cells_across(small.cols, cell), down = cells_across(small.rows, cell);
  for (int cy = 0; cy < down; ++cy)
    for (int cx = 0; cx < across; ++cx) {
      if (taken[static_cast<std::size_t>(cy * across + cx)] != 0) continue;
      cv::Point best(-1, -1);
      auto most = static_cast<float>(quality);
      for (int y = std::max(cy * cell, kMargin); y < std::min((cy + 1) * cell, small.rows - kMargin); ++y)
        for (int x = std::max(cx * cell, kMargin); x < std::min((cx + 1) * cell, small.cols - kMargin); ++x)
          if (response.at<float>(y, x) > most) most = response.at<float>(y, x), best = {x, y};
      if (best.x < 0) continue;
      tracks_.emplace_back().path.emplace_back(best);
    }
}

void PointTracks::measure_gradients(const cv::Mat& derivatives, int window) {
  constexpr float kScharr = 1.0F / 32.0F;  // of OpenCV's derivatives, to grey levels a px
  for (PointTrack& track : tracks_) {
    const cv::Point at(cvRound(track.path.back().x), cvRound(track.path.back().y));
    const cv::Rect box = cv::Rect(at.x - window / 2, at.y - window / 2, window, window) &
                         cv::Rect(0, 0, derivatives.cols, derivatives.rows);
    float xx = 0.0F, xy = 0.0F, yy = 0.0F;
    for (int y = box.y; y < box.y + box.height; ++y)
      for (int x = box.x; x < box.x + box.width; ++x) {
        const auto g = derivatives.at<cv::Vec2s>(y, x);
        const float gx = kScharr * static_cast<float>(g[0]), gy = kScharr * static_cast<float>(g[1]);
        xx += gx * gx, xy += gx * gy, yy += gy * gy;
      }
    track.gradients = {xx, xy, xy, yy};
  }
}

void PointTracks::advance(const cv::Mat& small, const EpipolarConfig& config) {
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(small, pyramid, {config.flow_window_px, config.flow_window_px}, kLevels);
  if (!pyramid_.empty()) follow(pyramid, config);
  const int cell = config.cell_px;
  std::vector<std::uint8_t> taken(
      static_cast<std::size_t>(cells_across(small.cols, cell) * cells_across(small.rows, cell)), 0);
  thin_out(small.size(), cell, taken);
  plant(small, cell, config.corner_response, taken);
  measure_gradients(pyramid[1], config.flow_window_px);
  pyramid_ = std::move(pyramid);
  ++frames_;
}

}  // namespace stillpoint
