#include "core/motion/stillpoint/depth_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>

#include "core/motion/stillpoint/depth_evidence.hpp"
#include "core/motion/stillpoint/label_propagation.hpp"
#include "core/motion/stillpoint/superpixel_motion.hpp"
#include "core/motion/stillpoint/superpixels.hpp"
#include "core/stopwatch.hpp"

namespace stillpoint {
namespace {

constexpr float kMostStill = 0.8F, kMostMoved = 1.6F;  // log-odds a superpixel's shift may give in one frame
constexpr float kDoubt = 1.0F;                         // log-odds: registration has outliers of its own
constexpr int kHole = 4;             // downsampled px: half of what a dynamic object may have unmeasured
constexpr float kStillLimit = 4.0F;  // of log-odds: so that a change of mind stays possible

/// The pixels of moving superpixels.
cv::Mat paint_moving(const cv::Mat& labels, const std::vector<Superpixel>& superpixels) {
  std::vector<uchar> moving{0};  // at label + 1: the first entry is for pixels in none
  for (const Superpixel& superpixel : superpixels) moving.push_back(superpixel.moving ? 255 : 0);
  cv::Mat image(labels.size(), CV_8UC1);
  for (int y = 0; y < labels.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    auto* out = image.ptr<uchar>(y);
    for (int x = 0; x < labels.cols; ++x) out[x] = moving[static_cast<std::size_t>(label[x] + 1)];
  }
  return image;
}

/// What superpixels say by their shifts, at label + 1: the first entry is for pixels in none. Frames in a row
/// see nearly the same shift, so each says only a part of it.
std::vector<float> evidence_of_shifts(const StillpointTrace& trace, const StillpointConfig& config) {
  std::vector<float> of_superpixel(trace.superpixels.size() + 1, 0.0F);
  for (const ReferenceEvidence& reference : trace.references)
    for (std::size_t i = 0; i < reference.motions.size(); ++i) {
      if (reference.motions[i].log_odds == 0.0F) continue;
      of_superpixel[i + 1] +=
          std::clamp(static_cast<float>(config.superpixel_share) * (reference.motions[i].log_odds - kDoubt),
                     -kMostStill, kMostMoved);
    }
  return of_superpixel;
}

/// Whether a reference measured a superpixel as a whole, at label + 1; empty where it measured none.
std::vector<std::uint8_t> measured_whole(const ReferenceEvidence& reference) {
  std::vector<std::uint8_t> whole;
  if (reference.motions.empty()) return whole;
  whole.push_back(0);
  for (const SuperpixelMotion& superpixel : reference.motions) whole.push_back(superpixel.log_odds != 0.0F);
  return whole;
}

/// Adds what one reference says of a row's pixels. Where a superpixel was measured as a whole, that a pixel
/// looks the same says nothing more: a slow dynamic object's pixels hardly change.
void add_pixels(const float* says, const std::vector<std::uint8_t>& whole, const int* label,
                std::vector<float>& sum) {
  if (whole.empty())
    for (std::size_t x = 0; x < sum.size(); ++x) sum[x] += says[x];
  else
    for (std::size_t x = 0; x < sum.size(); ++x)
      sum[x] += says[x] < 0 && whole[static_cast<std::size_t>(label[x] + 1)] != 0 ? 0.0F : says[x];
}

/// Memory and all evidence together: the trace's `slow` and `log_odds`. What is confidently known to be
/// dynamic is let go but slowly: people who stop go on.
void join_evidence(const StillpointConfig& config, StillpointTrace& trace) {
  const auto limit = static_cast<float>(config.max_log_odds),
             firm = static_cast<float>(config.confident_log_odds),
             release = static_cast<float>(config.hysteresis);
  const std::vector<float> shifts = evidence_of_shifts(trace, config);
  std::vector<std::vector<std::uint8_t>> whole;
  for (const ReferenceEvidence& reference : trace.references) whole.push_back(measured_whole(reference));
  trace.slow.create(trace.prior.size(), CV_32FC1);
  trace.log_odds.create(trace.prior.size(), CV_32FC1);
  std::vector<float> says(
      static_cast<std::size_t>(trace.prior.cols));  // of a row's pixels, by all references
  for (int y = 0; y < trace.prior.rows; ++y) {
    const auto* label = trace.labels.ptr<int>(y);
    const auto* before = trace.prior.ptr<float>(y);
    auto *slow = trace.slow.ptr<float>(y), *out = trace.log_odds.ptr<float>(y);
    std::fill(says.begin(), says.end(), 0.0F);
    for (std::size_t i = 0; i < whole.size(); ++i)
      add_pixels(trace.references[i].log_odds.ptr<float>(y), whole[i], label, says);
    for (std::size_t x = 0; x < says.size(); ++x) {
      slow[x] = shifts[static_cast<std::size_t>(label[x] + 1)];
      says[x] += slow[x];
    }
    for (std::size_t x = 0; x < says.size(); ++x) {
      const float share = before[x] > firm && says[x] < 0 ? release : 1.0F;
      out[x] = std::min(std::max(before[x] + share * says[x], -kStillLimit), limit);
    }
  }
}

void drop_small_regions(cv::Mat& mask, double min_area_share) {
  cv::Mat labels, stats, centroids;
  const int count = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8, CV_32S);
  const double least = min_area_share * static_cast<double>(mask.total());
  std::vector<std::uint8_t> keep(static_cast<std::size_t>(count), 0);
  for (int i = 1; i < count; ++i)
    keep[static_cast<std::size_t>(i)] = stats.at<int>(i, cv::CC_STAT_AREA) >= least;
  if (std::all_of(keep.begin() + 1, keep.end(), [](std::uint8_t k) { return k != 0; })) return;
  for (int y = 0; y < mask.rows; ++y) {
    const auto* label = labels.ptr<int>(y);
    auto* out = mask.ptr<uchar>(y);
    for (int x = 0; x < mask.cols; ++x)
      out[x] = keep[static_cast<std::size_t>(label[x])] != 0 ? out[x] : uchar{0};
  }
}

/// Whether a pixel without depth lies in a dynamic object: whether the nearest measured pixels to all four
/// sides do. The image's end says nothing against it. A gap between a dynamic object and what stands behind
/// it, the sensor's shadow, is open to one side.
bool enclosed_by_motion(const cv::Mat& mask, const cv::Mat& depth, int x, int y, int reach) {
  // One step to each side, px.
  constexpr std::array<std::array<int, 2>, 4> kSides{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
  const cv::Rect image({0, 0}, mask.size());
  return std::all_of(kSides.begin(), kSides.end(), [&](const std::array<int, 2>& side) {
    for (int step = 1; step <= reach; ++step) {
      const cv::Point p(x + step * side[0], y + step * side[1]);
      if (!image.contains(p)) return true;
      if (depth.ptr<float>(p.y)[p.x] > 0) return mask.ptr<uchar>(p.y)[p.x] != 0;
    }
    return false;
  });
}

/// Gives pixels without depth to the dynamic object that encloses them: hair and dark cloth are seldom
/// measured. The sensor's shadow beside a dynamic object is background, and stays out.
void fill_unmeasured(const cv::Mat& depth, int reach, cv::Mat& mask) {
  const cv::Rect dynamic = cv::boundingRect(mask);
  std::vector<cv::Point> inside;
  for (int y = dynamic.y; y < dynamic.br().y; ++y) {
    const auto* z = depth.ptr<float>(y);
    for (int x = dynamic.x; x < dynamic.br().x; ++x)
      if (z[x] <= 0 && enclosed_by_motion(mask, depth, x, y, reach)) inside.emplace_back(x, y);
  }
  for (const cv::Point& p : inside) mask.at<uchar>(p) = 255;
}

/// The measured ones of the 3x3 downsampled pixels about one: by whether they move, full-size pixels there
/// are judged.
class Neighbourhood {
 public:
  Neighbourhood(const cv::Mat& small_mask, const cv::Mat& small_depth, int sx, int sy) {
    for (int v = std::max(0, sy - 1); v <= std::min(small_mask.rows - 1, sy + 1); ++v)
      for (int u = std::max(0, sx - 1); u <= std::min(small_mask.cols - 1, sx + 1); ++u) {
        if (const float z = small_depth.ptr<float>(v)[u]; z > 0)
          depth_[count_] = z, moving_[count_++] = small_mask.ptr<uchar>(v)[u];
      }
  }

  /// What the pixel with the depth most like z (m) is.
  [[nodiscard]] uchar most_like(float z) const {
    uchar value = 0;
    float best = std::numeric_limits<float>::max();
    for (std::size_t i = 0; i < count_; ++i)
      if (const float difference = std::abs(depth_[i] - z); difference < best)
        best = difference, value = moving_[i];
    return value;
  }

  /// The same of a block's row, its unmeasured pixels 0; four at a time, as blocks mostly are wide.
  void most_like(const float* z, int width, uchar* out) const {
    int x = 0;
    for (; x + cv::v_float32x4::nlanes <= width; x += cv::v_float32x4::nlanes) {
      const cv::v_float32x4 depth = cv::v_load(z + x);
      cv::v_float32x4 best = cv::v_setall_f32(std::numeric_limits<float>::max()), value = cv::v_setzero_f32();
      for (std::size_t i = 0; i < count_; ++i) {
        const cv::v_float32x4 difference = cv::v_abs(cv::v_setall_f32(depth_[i]) - depth);
        const cv::v_float32x4 nearer = difference < best;
        best = cv::v_select(nearer, difference, best);
        value = cv::v_select(nearer, cv::v_setall_f32(moving_[i]), value);
      }
      const int moving = cv::v_signmask((value > cv::v_setzero_f32()) & (depth > cv::v_setzero_f32()));
      for (int k = 0; k < cv::v_float32x4::nlanes; ++k) out[x + k] = (moving >> k & 1) != 0 ? 255 : 0;
    }
    for (; x < width; ++x) out[x] = z[x] > 0 ? most_like(z[x]) : uchar{0};
  }

 private:
  std::array<float, 9> depth_{};
  std::array<uchar, 9> moving_{};
  std::size_t count_ = 0;
};

/// The small mask at full size, its outline fitted to the depth image.
cv::Mat fit_to_depth(const cv::Mat& small_mask, const RgbdView& view, const cv::Mat& full_depth) {
  constexpr int kReach = 3;  // px: the ragged rim of an outline is no wider
  if (cv::countNonZero(small_mask) == 0) return cv::Mat::zeros(full_depth.size(), CV_8UC1);
  cv::Mat low, high, mask;
  cv::erode(small_mask, low, cv::Mat());
  cv::dilate(small_mask, high, cv::Mat());
  const cv::Mat edge = low != high;
  mask = enlarged(small_mask, view.factor, full_depth.size());
  const int f = view.factor;
  std::vector<cv::Point> unmeasured, inside;
  for (int sy = 0; sy < edge.rows; ++sy)
    for (int sx = 0; sx < edge.cols; ++sx) {
      if (edge.ptr<uchar>(sy)[sx] == 0) continue;
      const Neighbourhood about(small_mask, view.depth, sx, sy);
      const int first = sx * f, end = std::min((sx + 1) * f, mask.cols);
      for (int y = sy * f; y < std::min((sy + 1) * f, mask.rows); ++y) {
        const auto* z = full_depth.ptr<float>(y);
        about.most_like(z + first, end - first, mask.ptr<uchar>(y) + first);
        for (int x = first; x < end; ++x)
          if (z[x] <= 0) unmeasured.emplace_back(x, y);
      }
    }
  for (const cv::Point& p : unmeasured)
    if (enclosed_by_motion(mask, full_depth, p.x, p.y, kReach)) inside.push_back(p);
  for (const cv::Point& p : inside) mask.at<uchar>(p) = 255;
  return mask;
}

/// What a superpixel was found to be becomes its pixels' prior; but neighbours alone make
/// nothing confident, or the prior would creep along every surface a dynamic object touches.
void remember_judgement(StillpointTrace& trace, const StillpointConfig& config) {
  const auto limit = static_cast<float>(config.moving_log_odds);
  for (int y = 0; y < trace.labels.rows; ++y) {
    const auto* label = trace.labels.ptr<int>(y);
    auto* log_odds = trace.log_odds.ptr<float>(y);
    for (int x = 0; x < trace.labels.cols; ++x) {
      if (label[x] < 0) continue;
      const Superpixel& superpixel = trace.superpixels[static_cast<std::size_t>(label[x])];
      const float odds = log_odds[x];
      const bool agrees = superpixel.moving && odds > superpixel.log_odds;
      const float joined = agrees ? odds : 0.5F * (odds + superpixel.log_odds);
      log_odds[x] = std::min(joined, std::max(std::max(odds, superpixel.evidence), limit));
    }
  }
}

/// What one reference says, given the superpixels' labels and the prior.
ReferenceEvidence evidence_of_reference(const RgbdView& current, ReferenceView reference,
                                        const StillpointTrace& trace, const StillpointConfig& config) {
  const Stopwatch watch;
  SuperpixelMotions measured;
  if (reference.old) {
    measured = measure_superpixels(current, reference, trace.labels, trace.superpixels, trace.prior, config);
    reference.reference_from_current = measured.reference_from_current;
  }
  ReferenceEvidence evidence = compare_with_reference(current, reference, trace.prior, config);
  evidence.motions = std::move(measured.motions);
  evidence.reference = reference;
  evidence.ms = watch.milliseconds();
  return evidence;
}

}  // namespace

StillpointTrace detect_depth_motion(const RgbdView& current, Superpixels superpixels,
                                    const cv::Mat& full_depth, const std::vector<ReferenceView>& references,
                                    const MotionPrior* prior, const Pose& previous_from_current,
                                    const StillpointConfig& config, int threads) {
  StillpointTrace trace;
  Stopwatch watch;
  if (prior) {
    const WarpedPrior warped = warp_prior(current, *prior, previous_from_current, config);
    trace.prior = warped.log_odds;
    if (config.label_propagation) propagate_labels(warped.newly_observed, superpixels, trace.prior);
  } else {
    trace.prior = cv::Mat::zeros(current.depth.size(), CV_32FC1);
  }
  trace.labels = std::move(superpixels.labels);
  trace.superpixels = std::move(superpixels.all);
  trace.ms.prior = watch.lap();
  // References know nothing of each other: all but the last are compared with beside it.
  std::vector<std::future<ReferenceEvidence>> compared;
  for (std::size_t i = 0; i < references.size(); ++i)
    compared.push_back(
        std::async(threads > 1 && i + 1 < references.size() ? std::launch::async : std::launch::deferred,
                   [&, i] { return evidence_of_reference(current, references[i], trace, config); }));
  if (!compared.empty()) compared.back().wait();
  for (std::future<ReferenceEvidence>& one : compared) trace.references.push_back(one.get());
  (void)watch.lap();
  join_evidence(config, trace);
  judge_superpixels(trace.log_odds, trace.labels, superpixels.adjacency, config, trace.superpixels);
  trace.ms.superpixels = watch.lap();
  trace.small_mask = paint_moving(trace.labels, trace.superpixels);
  drop_small_regions(trace.small_mask, config.min_area_share);
  fill_unmeasured(current.depth, kHole, trace.small_mask);
  trace.mask = fit_to_depth(trace.small_mask, current, full_depth);
  if (config.margin_px > 0) {
    const int side = 2 * config.margin_px + 1;
    cv::dilate(trace.mask, trace.mask, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  }
  trace.mask_share =
      static_cast<double>(cv::countNonZero(trace.mask)) / static_cast<double>(trace.mask.total());
  trace.ms.mask = watch.lap();
  if (references.empty()) trace.note = "no earlier frame with depth to compare with";

  remember_judgement(trace, config);
  return trace;
}

}  // namespace stillpoint
