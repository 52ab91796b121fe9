#include "core/sequence/stereo/pair_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/features2d.hpp>

namespace stillpoint {
namespace {

constexpr int kCorners = 800, kLevels = 3;  // fine levels alone: rows are wanted to a fraction of a pixel
constexpr int kFewestMatches = 40;          // over all pairs: fewer say nothing
constexpr float kMostDistance = 40.0F;      // bits, of descriptors
constexpr double kMostAside = 0.08, kMostAlong = 0.4;  // of the image's sides: farther apart is chance
constexpr double kLeastShift = 0.5;                    // px: nearer to 0 is far away
constexpr double kExchanged = 0.85;                    // of the matches
// Between rows of a pair: beyond either, matching along rows finds little.
constexpr double kMostOffset = 1.0, kMostSpread = 2.5;  // px

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Corners of one pair: how far right-hand ones lie beside and below left-hand ones, px.
void match_corners(const cv::Mat& left, const cv::Mat& right, std::vector<double>& along,
                   std::vector<double>& rows) {
  const auto orb = cv::ORB::create(kCorners, 1.2F, kLevels);
  std::vector<cv::KeyPoint> there[2];
  cv::Mat descriptors[2];
  orb->detectAndCompute(left, cv::noArray(), there[0], descriptors[0]);
  orb->detectAndCompute(right, cv::noArray(), there[1], descriptors[1]);
  if (there[0].empty() || there[1].empty()) return;
  std::vector<cv::DMatch> matches;
  cv::BFMatcher(cv::NORM_HAMMING, true).match(descriptors[0], descriptors[1], matches);
  for (const cv::DMatch& match : matches) {
    const cv::Point2f step = there[1][static_cast<std::size_t>(match.trainIdx)].pt -
                             there[0][static_cast<std::size_t>(match.queryIdx)].pt;
    if (match.distance > kMostDistance || std::abs(step.y) > kMostAside * left.rows ||
        std::abs(step.x) > kMostAlong * left.cols)
      continue;
    along.push_back(static_cast<double>(step.x));
    rows.push_back(static_cast<double>(step.y));
  }
}

}  // namespace

PairSurvey survey_pairs(const std::vector<PairPaths>& pairs, const ImageReader& read_image) {
  PairSurvey survey;
  std::vector<double> along, rows;
  for (const PairPaths& pair : pairs) {
    const ImageRead left = read_image(pair.left), right = read_image(pair.right);
    if (left.image.empty() || right.image.empty()) continue;
    ++survey.pairs;
    if (left.image.size() != right.image.size()) {
      if (survey.fault.empty())
        survey.fault = fmt::format("{} is {}x{} px, but its left image is {}x{} px", pair.right,
                                   right.image.cols, right.image.rows, left.image.cols, left.image.rows);
      continue;
    }
    ++survey.fit;
    match_corners(to_gray(to_8bit(left.image)), to_gray(to_8bit(right.image)), along, rows);
  }
  survey.matches = static_cast<int>(rows.size());
  survey.row_offset_px = quantile(rows, 0.5);
  for (double& row : rows) row = std::abs(row - survey.row_offset_px);
  survey.row_spread_px = quantile(rows, 0.75);
  const auto shifted =
      std::count_if(along.begin(), along.end(), [](double x) { return std::abs(x) > kLeastShift; });
  const auto wrong = std::count_if(along.begin(), along.end(), [](double x) { return x > kLeastShift; });
  survey.to_the_left = shifted > 0 ? static_cast<double>(wrong) / static_cast<double>(shifted) : 0.0;
  return survey;
}

bool is_exchanged(const PairSurvey& survey) {
  return survey.matches >= kFewestMatches && survey.to_the_left > kExchanged;
}

bool is_unrectified(const PairSurvey& survey) {
  return survey.matches >= kFewestMatches &&
         (std::abs(survey.row_offset_px) > kMostOffset || survey.row_spread_px > kMostSpread);
}

}  // namespace stillpoint
