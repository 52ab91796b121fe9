#include "core/motion/yi2013.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "core/stopwatch.hpp"

namespace stillpoint {

void Yi2013Config::list(ParameterTable& table) {
  table.number("median_radius_px", median_radius_px, 2, 0, 10, "px",
               "radius of the median filter before all else; 2 = 5x5");
  table.number("cell_width_px", cell_width_px, 32, 4, 256, "px", "a cell this wide holds one followed point");
  table.number("cell_height_px", cell_height_px, 24, 4, 256, "px", "height of such a cell");
  table.number("window_px", window_px, 10, 3, 51, "px", "side of the Lucas-Kanade window");
  table.number("levels", levels, 3, 0, 8, "", "pyramid levels above the image itself");
  table.number("iterations", iterations, 20, 1, 100, "", "Lucas-Kanade steps a level, at most");
  table.number("epsilon_px", epsilon_px, 0.03, 1e-4, 1, "px", "a shorter Lucas-Kanade step is the last one");
  table.number("min_tracks", min_tracks, 10, 4, 10000, "points",
               "with fewer followed points the camera is taken to are static");
  table.number("ransac_px", ransac_px, 1.0, 0.05, 20, "px", "inliers lie this close to the homography");
  table.number("block_px", block_px, 4, 1, 32, "px", "side of a block of the background model");
  table.number("initial_sigma", initial_sigma, 20.0, 1, 128, "grey levels",
               "standard deviation of a Gaussian that begins");
  table.number("least_sigma", least_sigma, 5.0, 0.5, 128, "grey levels",
               "a Gaussian's standard deviation is at least this");
  table.number("max_age", max_age, 30.0, 2, 1000, "frames", "so many frames a Gaussian stands for, at most");
  table.number("decay", decay, 0.001, 0, 1, "per squared grey level",
               "how fast age falls where warping mixes unlike blocks");
  table.number("decay_above_sigma", decay_above_sigma, 50.0, 0, 255, "grey levels",
               "standard deviation above which age falls");
  table.number("match_limit", match_limit, 2.0, 0.1, 100, "",
               "a block belongs to a Gaussian up to this many variances from its mean, squared");
  table.number("moving_limit", moving_limit, 4.0, 0.1, 100, "",
               "a pixel is dynamic beyond so many variances from the apparent mean, squared");
  table.number("settled_age", settled_age, 1.0, 0, 1000, "frames",
               "an apparent Gaussian up to this age judges no pixel");
}

// ---- Motion ----

namespace {

/// Centres of the grid's whole cells.
std::vector<cv::Point2f> grid_points(const cv::Size& size, const Yi2013Config& config) {
  std::vector<cv::Point2f> points;
  const int w = config.cell_width_px, h = config.cell_height_px;
  for (int y = 0; y + h <= size.height; y += h)
    for (int x = 0; x + w <= size.width; x += w)
      points.emplace_back(static_cast<float>(x) + 0.5F * static_cast<float>(w),
                          static_cast<float>(y) + 0.5F * static_cast<float>(h));
  return points;
}

std::vector<cv::Mat> flow_pyramid(const cv::Mat& gray, const Yi2013Config& config) {
  std::vector<cv::Mat> pyramid;
  cv::buildOpticalFlowPyramid(gray, pyramid, {config.window_px, config.window_px}, config.levels, false);
  return pyramid;
}

}  // namespace

Yi2013Motion yi2013_motion(const std::vector<cv::Mat>& here, const std::vector<cv::Mat>& last,
                           const Yi2013Config& config) {
  Yi2013Motion motion;
  const std::vector<cv::Point2f> points = grid_points(here.front().size(), config);
  motion.points = static_cast<int>(points.size());
  std::vector<cv::Point2f> from, to;
  if (!points.empty()) {
    std::vector<cv::Point2f> found;
    std::vector<std::uint8_t> is_found;
    const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, config.iterations,
                                config.epsilon_px);
    cv::calcOpticalFlowPyrLK(here, last, points, found, is_found, cv::noArray(),
                             {config.window_px, config.window_px}, config.levels, stop);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (is_found[i] != 0) from.push_back(points[i]), to.push_back(found[i]);
  }
  for (std::size_t i = 0; i < from.size(); ++i) motion.tracks.push_back({from[i], to[i], false});
  if (static_cast<int>(from.size()) < config.min_tracks) {
    motion.note =
        fmt::format("only {} points could be followed: the camera is taken to are static", from.size());
    return motion;
  }
  std::vector<std::uint8_t> agrees;
  const cv::Mat homography = cv::findHomography(from, to, cv::RANSAC, config.ransac_px, agrees);
  if (homography.empty()) {
    motion.note = "no homography fits the followed points: the camera is taken to are static";
    return motion;
  }
  motion.last_from_here = cv::Matx33d(homography);
  for (std::size_t i = 0; i < agrees.size(); ++i) motion.tracks[i].inlier = agrees[i] != 0;
  motion.inliers = cv::countNonZero(agrees);
  return motion;
}

// ---- The background model ----

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

OldPlace old_place(double u, double v, const cv::Size& size) {
  OldPlace place;
  // Also false for NaN, as of a place behind the camera.
  if (!(u > -1.0 && v > -1.0 && u < size.width + 1.0 && v < size.height + 1.0)) return place;
  const int bx = static_cast<int>(u + 1.0) - 1, by = static_cast<int>(v + 1.0) - 1;
  const double dx = u - bx - 0.5, dy = v - by - 0.5;
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

Yi2013Model yi2013_warped(const Yi2013Model& last, const cv::Matx33d& last_from_here,
                          const Yi2013Blocks& blocks, const Yi2013Config& config) {
  const cv::Size size = blocks.mean.size();
  Yi2013Model warped{gaussians(size), gaussians(size)};
  const bool begins = last[0].mean.size() != size;
  const auto initial = static_cast<float>(config.initial_sigma * config.initial_sigma);
  const auto least = static_cast<float>(config.least_sigma * config.least_sigma);
  const auto calm = static_cast<float>(config.decay_above_sigma * config.decay_above_sigma);
  const auto decay = static_cast<float>(config.decay), oldest = static_cast<float>(config.max_age);
  const double side = config.block_px, middle = 0.5 * side;
  const cv::Matx33d& h = last_from_here;
  for (int by = 0; by < size.height; ++by) {
    const double y = by * side + middle;
    const auto* seen = blocks.mean.ptr<float>(by);
    for (int bx = 0; bx < size.width; ++bx) {
      const double x = bx * side + middle;
      const double depth = h(2, 0) * x + h(2, 1) * y + h(2, 2);
      const double scale = depth > 0.0 ? 1.0 / (depth * side) : std::numeric_limits<double>::quiet_NaN();
      OldPlace place;
      if (!begins)
        place = old_place(scale * (h(0, 0) * x + h(0, 1) * y + h(0, 2)),
                          scale * (h(1, 0) * x + h(1, 1) * y + h(1, 2)), size);
      for (std::size_t mode = 0; mode < 2; ++mode) {
        const auto *means = last[mode].mean.ptr<float>(), *variances = last[mode].variance.ptr<float>(),
                   *ages = last[mode].age.ptr<float>();
        float mean = 0.0F, variance = 0.0F, age = 0.0F;
        const auto count = static_cast<std::size_t>(place.count);
        for (std::size_t k = 0; k < count; ++k) {
          mean += place.share[k] * means[place.at[k]];
          age += place.share[k] * ages[place.at[k]];
        }
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

// ---- The method ----

namespace {

/// What the next frame needs of this one: never changed once it is made, so that copies may share it.
struct State {
  int index = -1;
  int frames = 0;                ///< since the model began
  std::vector<cv::Mat> pyramid;  ///< of the filtered frame, which is its first level
  Yi2013Model model;
};

struct Trace final : MotionTrace {
  std::shared_ptr<const State> last, after;  ///< `last` is null where the model begins
  Yi2013Motion motion;
  Yi2013Model chosen;  ///< the last model in this frame's pixels, before this frame went into it
  cv::Mat matches, mask;
  double ms_motion = 0.0, ms_warp = 0.0, ms_update = 0.0, ms_mask = 0.0;
};

double share_of(const cv::Mat& matches, Yi2013Match match) {
  return static_cast<double>(cv::countNonZero(matches == match)) / static_cast<double>(matches.total());
}

/// A frame's way through the method, as data.
class Stages {
 public:
  Stages(const Frame& frame, const Trace& trace, const Yi2013Config& config, StageLog& log)
      : trace_(trace),
        config_(config),
        log_(log),
        gray_(trace.after->pyramid.front().clone()),
        frame_(photo_layer(fmt::format("Frame {}", frame.index), frame.gray)),
        filtered_(photo_layer(fmt::format("Frame {}, median", frame.index), gray_)) {}

  void add_all() {
    log_.small_factor = config_.block_px;
    if (trace_.last) add_motion();
    add_matches();
    add_update();
    add_mask();
    log_.explain = [gray = gray_, trace = trace_, config = config_](const cv::Point2f& pixel, bool) {
      return explained(gray, trace, config, pixel);
    };
  }

 private:
  static constexpr const char* kMotion = "Camera's motion";
  static constexpr const char* kModel = "Background model";
  static constexpr const char* kDetection = "Detection";

  [[nodiscard]] static Layer mean_layer(std::string name, const cv::Mat& mean, std::string id) {
    Layer layer = photo_layer(std::move(name), mean, FrameSpace::kSmall);
    layer.id = std::move(id);
    return layer;
  }
  [[nodiscard]] static Layer sigma_layer(std::string name, const cv::Mat& variance, std::string id) {
    cv::Mat sigma;
    cv::sqrt(variance, sigma);
    Layer layer = length_layer(std::move(name), sigma, "grey levels", FrameSpace::kSmall);
    layer.id = std::move(id);
    return layer;
  }
  [[nodiscard]] Layer age_layer(std::string name, const cv::Mat& age, std::string id) const {
    Layer layer = length_layer(std::move(name), age, "frames", FrameSpace::kSmall);
    layer.range = config_.max_age;
    layer.id = std::move(id);
    return layer;
  }

  void add_motion() {
    const Yi2013Motion& motion = trace_.motion;
    const cv::Mat last = trace_.last->pyramid.front().clone();
    const cv::Matx33d& h = motion.last_from_here;
    log_.reference = trace_.last->index;
    log_.reference_gray = last;
    if (std::abs(cv::determinant(h)) > 1e-12) log_.forward = h.inv(), log_.backward = h;

    std::vector<Mark> marks;
    for (const Yi2013Track& track : motion.tracks)
      marks.push_back({track.here, track.there, track.inlier ? MarkKind::kInlier : MarkKind::kOutlier});
    Layer tracks = marked("Grid points, and where they were", frame_, std::move(marks));
    tracks.id = "flow_tracks";
    Stage& flow = log_.add("flow", kMotion, "Grid flow",
                           "Follows the centres of a regular grid from this frame to the last.");
    flow.ms = trace_.ms_motion;
    flow.overview = true;
    flow.figure("Grid points", motion.points)
        .figure("Followed", static_cast<double>(motion.tracks.size()))
        .figure("Inliers", motion.inliers);
    flow.add_side({frame_, filtered_}, tracks);

    Layer warped = photo_layer("Last frame, warped", cv::Mat(), FrameSpace::kCompensatedForward);
    cv::warpPerspective(last, warped.image, h, last.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
    warped.id = "compensated";
    Stage& homography = log_.add("homography", kMotion, "Homography",
                                 "Finds where RANSAC's majority of the points was in the last frame.");
    homography.timed = false;
    homography.note = motion.note;
    for (int i = 0; i < 9; ++i)
      homography.figure(fmt::format("h{}{}", i / 3 + 1, i % 3 + 1), h(i / 3, i % 3), "", i >= 6 ? 7 : 4);
    homography.add_side({tracks, photo_layer("Last frame, median", last, FrameSpace::kReference)}, warped);
  }

  void add_matches() {
    Layer matches;
    matches.name = "Which matched: 0 apparent, 1 candidate, 2 neither";
    matches.kind = LayerKind::kLevels;
    matches.image = trace_.matches;
    matches.range = kMatchNeither;
    matches.space = FrameSpace::kSmall;
    matches.id = "matches";
    Stage& stage = log_.add("match", kModel, "Match",
                            "Warps the last model here, lets older candidates become apparent, and finds the "
                            "Gaussian each block belongs to.");
    stage.ms = trace_.ms_warp;
    stage.figure("Apparent", 100.0 * share_of(trace_.matches, kMatchApparent), "%", 1)
        .figure("Candidate", 100.0 * share_of(trace_.matches, kMatchCandidate), "%", 1)
        .figure("Neither", 100.0 * share_of(trace_.matches, kMatchNeither), "%", 1);
    if (!trace_.last) stage.note = "The model begins with this frame.";
    stage.add_side({filtered_, mean_layer("Apparent mean, warped", trace_.chosen[0].mean, "warped_mean_0"),
                    age_layer("Apparent age, warped", trace_.chosen[0].age, "warped_age_0")},
                   matches);
  }

  void add_update() {
    const Yi2013Model &before = trace_.chosen, &after = trace_.after->model;
    Stage& stage = log_.add("update", kModel, "Update",
                            "Averages each block into the Gaussian it belongs to, by that Gaussian's age.");
    stage.ms = trace_.ms_update;
    stage.overview = true;
    stage.figure("Mean age, apparent", cv::mean(after[0].age)[0], "frames", 1)
        .figure("Mean age, candidate", cv::mean(after[1].age)[0], "frames", 1);
    const char* const names[] = {"Apparent", "Candidate"};
    for (std::size_t mode = 0; mode < 2; ++mode) {
      const std::string name = names[mode];
      stage.add_side({mean_layer("μ, warped", before[mode].mean, "")},
                     mean_layer("μ", after[mode].mean, fmt::format("mean_{}", mode)), name + " mean");
      stage.add_side({sigma_layer("σ, warped", before[mode].variance, "")},
                     sigma_layer("σ", after[mode].variance, fmt::format("sigma_{}", mode)), name + " sigma");
      stage.add_side({age_layer("Age, warped", before[mode].age, "")},
                     age_layer("Age", after[mode].age, fmt::format("age_{}", mode)), name + " age");
    }
  }

  void add_mask() {
    const cv::Mat& mask = trace_.mask;
    const int side = config_.block_px;
    cv::Mat deviation(mask.size(), CV_32FC1, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
    for (int y = 0; y < trace_.matches.rows * side; ++y)
      for (int x = 0; x < trace_.matches.cols * side; ++x)
        if (static_cast<double>(trace_.chosen[0].age.at<float>(y / side, x / side)) > config_.settled_age)
          deviation.at<float>(y, x) = std::abs(gray_.at<std::uint8_t>(y, x) -
                                               trace_.after->model[0].mean.at<float>(y / side, x / side)) /
                                      std::sqrt(trace_.chosen[0].variance.at<float>(y / side, x / side));
    const double limit = std::sqrt(config_.moving_limit);
    Layer off;
    off.name = "Deviation from the apparent background";
    off.kind = LayerKind::kLength;
    off.image = deviation;
    off.range = 2.0 * limit;
    off.unit = "σ";
    off.limit = limit;
    off.id = "deviation";
    Stage& stage =
        log_.add("deviation", kDetection, "Deviation",
                 "Compares each pixel with its block's apparent Gaussian, where that is old enough.");
    stage.timed = false;
    stage.overview = true;
    stage.figure("Judged", percent_known(deviation), "%", 1);
    stage.add_side({filtered_, mean_layer("Apparent mean", trace_.after->model[0].mean, "")}, off);

    Stage& end =
        log_.add("mask", kDetection, "Mask", "Sets the pixels beyond the limit; nothing is cleaned up.");
    end.ms = trace_.ms_mask;
    end.overview = true;
    end.figure("Mask", percent_set(mask), "%", 2);
    end.add_side({off}, mask_layer("Mask", mask, frame_, "mask"));
  }

  static std::vector<std::string> explained(const cv::Mat& gray, const Trace& trace,
                                            const Yi2013Config& config, const cv::Point2f& pixel) {
    const int x = cvRound(pixel.x), y = cvRound(pixel.y), bx = x / config.block_px, by = y / config.block_px;
    if (x < 0 || y < 0 || x >= gray.cols || y >= gray.rows) return {};
    if (bx >= trace.matches.cols || by >= trace.matches.rows)
      return {"It lies in a strip narrower than a block, where nothing is judged."};
    const Yi2013Gaussians &chosen = trace.chosen[0], &after = trace.after->model[0];
    const auto age = static_cast<double>(chosen.age.at<float>(by, bx));
    std::vector<std::string> sentences;
    if (age > config.settled_age) {
      const auto mean = static_cast<double>(after.mean.at<float>(by, bx));
      const double sigma = std::sqrt(static_cast<double>(chosen.variance.at<float>(by, bx)));
      const int level = gray.at<std::uint8_t>(y, x);
      const bool moves = trace.mask.at<std::uint8_t>(y, x) != 0;
      sentences.push_back(
          fmt::format("It is {} grey levels bright; the apparent background of its block is {:.1f} ± {:.1f}, "
                      "after {:.1f} "
                      "frames: {:.1f} σ away, {} the limit of {:.1f} σ.",
                      level, mean, sigma, age, std::abs(level - mean) / sigma, moves ? "beyond" : "within",
                      std::sqrt(config.moving_limit)));
    } else {
      sentences.push_back(fmt::format(
          "The apparent background of its block stands for {:.1f} frames: too few to judge by.", age));
    }
    const auto match = trace.matches.at<std::uint8_t>(by, bx);
    sentences.emplace_back(
        match == kMatchApparent    ? "The block as a whole belongs to the apparent background."
        : match == kMatchCandidate ? "The block as a whole belongs to the candidate background."
                                   : "The block as a whole begins the candidate background anew.");
    return sentences;
  }

  const Trace& trace_;
  const Yi2013Config& config_;
  StageLog& log_;
  cv::Mat gray_;
  Layer frame_, filtered_;
};

class Yi2013Method final : public MotionMethod {
 public:
  explicit Yi2013Method(const Yi2013Config& config) : config_(config) {}

  [[nodiscard]] std::unique_ptr<MotionMethod> clone() const override {
    return std::make_unique<Yi2013Method>(*this);
  }

  [[nodiscard]] MotionResult detect(const MotionInput& input) const override {
    MotionResult result;
    const cv::Mat& seen = input.frame.gray;
    if (std::min(seen.cols, seen.rows) < config_.block_px) {
      result.note = "the image is smaller than a block of the background model";
      return result;
    }
    auto trace = std::make_shared<Trace>();
    auto after = std::make_shared<State>();
    Stopwatch watch;
    cv::Mat gray;
    cv::medianBlur(seen, gray, 2 * config_.median_radius_px + 1);
    after->pyramid = flow_pyramid(gray, config_);
    if (state_ && state_->pyramid.front().size() == gray.size()) {
      trace->last = state_;
      trace->motion = yi2013_motion(after->pyramid, state_->pyramid, config_);
    }
    trace->ms_motion = watch.lap();
    const Yi2013Blocks blocks = yi2013_blocks(gray, config_.block_px);
    trace->chosen = yi2013_warped(trace->last ? trace->last->model : Yi2013Model(),
                                  trace->motion.last_from_here, blocks, config_);
    trace->matches = yi2013_choose(trace->chosen, blocks, config_);
    trace->ms_warp = watch.lap();
    after->model = yi2013_updated(trace->chosen, trace->matches, blocks, config_);
    trace->ms_update = watch.lap();
    trace->mask = yi2013_moving(gray, trace->chosen, after->model, config_);
    trace->ms_mask = watch.lap();
    after->index = input.frame.index;
    after->frames = trace->last ? trace->last->frames + 1 : 1;

    result.mask = trace->mask;
    result.mask_share = percent_set(trace->mask) / 100.0;
    if (trace->last)
      result.figures = {static_cast<double>(trace->motion.tracks.size()),
                        static_cast<double>(trace->motion.inliers), share_of(trace->matches, kMatchApparent)};
    result.note = trace->last ? trace->motion.note : "the background model begins with this frame";
    trace->after = std::move(after);
    result.trace = std::move(trace);
    return result;
  }

  void commit(const MotionInput&, const MotionResult& result, const MotionOutcome&) override {
    if (result.trace) state_ = static_cast<const Trace&>(*result.trace).after;
  }

  /// Gaussians forget what lies farther back than their oldest age, but for a small share.
  [[nodiscard]] int frames_back() const override { return static_cast<int>(std::ceil(config_.max_age)); }

  [[nodiscard]] bool settled() const override {
    return state_ && static_cast<double>(state_->frames) > config_.settled_age;
  }

  [[nodiscard]] std::unique_ptr<MotionMethod> with_config(const Config& config) const override {
    return config.of<Yi2013Config>() == config_ ? clone() : nullptr;
  }

  [[nodiscard]] StageLog describe(const Frame& frame, const MotionResult& result) const override {
    StageLog log;
    log.note = result.note;
    if (result.trace) Stages(frame, static_cast<const Trace&>(*result.trace), config_, log).add_all();
    return log;
  }

 private:
  Yi2013Config config_;
  std::shared_ptr<const State> state_;  // null before the first frame
};

}  // namespace

MethodInfo yi2013_method() {
  MethodInfo info;
  info.name = "yi2013";
  info.title = "Yi et al. 2013";
  info.summary = "A background of two Gaussians a block, warped by a homography of grid points.";
  info.citation =
      "Yi K. M., Yun K., Kim S. W., Chang H. J., Choi J. Y.: Detection of moving objects with non-stationary "
      "cameras in 5.8 ms, CVPRW 2013";
  info.needs.keeps_state = true;
  info.parameters = AnySection(Yi2013Config());
  info.figures = {
      {"yi2013_tracks", FigureUnit::plain, "grid points followed to the last frame", 0},
      {"yi2013_inliers", FigureUnit::plain, "of those, the ones that agree with the homography", 0},
      {"yi2013_apparent", FigureUnit::share, "blocks that belong to the apparent background", 4}};
  info.make = [](const Camera&, const Config& config) -> std::unique_ptr<MotionMethod> {
    return std::make_unique<Yi2013Method>(config.of<Yi2013Config>());
  };
  return info;
}

}  // namespace stillpoint
