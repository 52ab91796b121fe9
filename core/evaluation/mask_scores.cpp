#include "core/evaluation/mask_scores.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.hpp"

namespace stillpoint {
namespace {

std::optional<double> share(std::int64_t part, std::int64_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::optional<double> MaskScore::precision() const {
  return share(found_rightly, found_rightly + found_wrongly);
}
std::optional<double> MaskScore::recall() const { return share(found_rightly, found_rightly + missed); }
std::optional<double> MaskScore::iou() const {
  return share(found_rightly, found_rightly + found_wrongly + missed);
}

MaskScore& MaskScore::operator+=(const MaskScore& other) {
  found_rightly += other.found_rightly;
  found_wrongly += other.found_wrongly;
  missed += other.missed;
  left_rightly += other.left_rightly;
  return *this;
}

MaskScore score_mask(const cv::Mat& found, const cv::Mat& truth) {
  MaskScore score;
  if (truth.empty()) return score;
  if (!found.empty() && found.size() != truth.size())
    throw InputError(fmt::format("a mask of {}x{} px cannot be scored against a truth of {}x{} px",
                                 found.cols, found.rows, truth.cols, truth.rows));
  const std::int64_t moving = cv::countNonZero(truth);
  const std::int64_t all = static_cast<std::int64_t>(truth.total());
  if (!found.empty()) {
    score.found_rightly = cv::countNonZero((found != 0) & (truth != 0));
    score.found_wrongly = cv::countNonZero(found) - score.found_rightly;
  }
  score.missed = moving - score.found_rightly;
  score.left_rightly = all - moving - score.found_wrongly;
  return score;
}

std::optional<double> RemovalScore::precision() const {
  return share(removed_rightly, removed_rightly + removed_wrongly);
}
std::optional<double> RemovalScore::recall() const {
  return share(removed_rightly, removed_rightly + kept_wrongly);
}

RemovalScore& RemovalScore::operator+=(const RemovalScore& other) {
  removed_rightly += other.removed_rightly;
  removed_wrongly += other.removed_wrongly;
  kept_wrongly += other.kept_wrongly;
  kept_rightly += other.kept_rightly;
  return *this;
}

bool is_dynamic_at(const cv::Mat& truth, const cv::Point2f& pixel) {
  return truth.at<uchar>(std::clamp(cvRound(pixel.y), 0, truth.rows - 1),
                         std::clamp(cvRound(pixel.x), 0, truth.cols - 1)) != 0;
}

RemovalScore score_removal(const std::vector<FeatureVerdict>& features, const cv::Mat& truth) {
  RemovalScore score;
  if (truth.empty()) return score;
  for (const FeatureVerdict& feature : features) {
    const bool moves = is_dynamic_at(truth, feature.pixel);
    auto& count = feature.removed ? (moves ? score.removed_rightly : score.removed_wrongly)
                                  : (moves ? score.kept_wrongly : score.kept_rightly);
    ++count;
  }
  return score;
}

}  // namespace stillpoint
