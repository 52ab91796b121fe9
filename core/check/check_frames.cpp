#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/check/findings.hpp"
#include "core/counted.hpp"
#include "core/median.hpp"
#include "core/sequence/frame.hpp"
#include "core/sequence/source.hpp"

namespace stillpoint {
namespace {

constexpr double kLongGap = 10.0;      // times the median step
constexpr double kLongGapLeast = 0.5;  // s: shorter ones of fast cameras are no gaps to a hand
constexpr int kPairsSampled = 12;      // neighbours compared in search of repeats

/// What a sentence told on opening is about, by its words. Those of a bag's topic, with which it may begin,
/// say nothing: /camera/… is of images and depth.
std::string subject_of(const std::string& whole) {
  const auto topic = whole.find(":/");
  const auto said = topic == std::string::npos ? topic : whole.find(' ', topic);
  const std::string sentence = said == std::string::npos ? whole : whole.substr(said);
  const auto speaks_of = [&](const char* word) { return sentence.find(word) != std::string::npos; };
  if (speaks_of("groundtruth") || speaks_of("ground truth") || speaks_of(".gt.freiburg") ||
      speaks_of("poses"))
    return "truth";
  if (speaks_of("mask")) return "masks";
  if (speaks_of("units a metre") || speaks_of("depth image") || speaks_of("depth is of") ||
      speaks_of("depth in metres") || speaks_of("is depth ") || speaks_of("right image") ||
      speaks_of("matched corners"))
    return "depth";
  if (speaks_of("times of recording")) return "stamps";
  if (speaks_of("camera") || speaks_of("distortion")) return "camera";
  if (speaks_of("stamp")) return "stamps";
  return "images";
}

void check_gaps(const FrameSource& source, std::vector<Finding>& findings) {
  std::vector<double> steps;
  for (int i = 1; i < source.size(); ++i) steps.push_back(source.timestamp(i) - source.timestamp(i - 1));
  if (steps.size() < 3) return;
  std::vector<double> order = steps;
  const double usual = median_of(order), limit = std::max(kLongGapLeast, kLongGap * usual);
  const auto longest = std::max_element(steps.begin(), steps.end());
  if (*longest <= limit) return;
  const auto gaps = std::count_if(steps.begin(), steps.end(), [limit](double step) { return step > limit; });
  findings.push_back(
      {"stamps", fmt::format("{} in time longer than {:.2f} s where a step is {:.3f} s; the longest, "
                             "{:.3f} s, follows frame {}: the odometry may be lost there",
                             counted(gaps, "gap"), limit, usual, *longest, longest - steps.begin())});
}

bool are_same(const cv::Mat& a, const cv::Mat& b) {
  return !a.empty() && a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

/// Depth of a wall seen straight on is the same in every frame, and no repeat.
bool has_relief(const cv::Mat& depth) {
  double least = 0, most = 0;
  cv::minMaxLoc(depth, &least, &most);
  return most > least;
}

void check_repeats(const FrameSource& source, std::vector<Finding>& findings) {
  const int pairs = std::min(kPairsSampled, source.size() - 1);
  int colour = 0, depth = 0, with_depth = 0, first = -1;
  for (int i = 0; i < pairs; ++i) {
    const int index = static_cast<int>(static_cast<long>(i) * (source.size() - 1) / pairs);
    const Frame a = source.read(index), b = source.read(index + 1);
    const bool same = are_same(a.gray, b.gray);
    colour += same ? 1 : 0;
    if (same && first < 0) first = index;
    with_depth += a.has_depth() && b.has_depth() ? 1 : 0;
    depth += are_same(a.depth, b.depth) && has_relief(a.depth) ? 1 : 0;
  }
  if (colour > 0)
    findings.push_back(
        {"images",
         fmt::format("{} of {} sampled colour images are the same, pixel for pixel, as the one before; "
                     "the first is frame {}",
                     colour, pairs, first + 1)});
  if (depth > colour)
    findings.push_back(
        {"depth",
         fmt::format("{} of {} sampled depth images are the same, pixel for pixel, as the one before, "
                     "though their colour images differ",
                     depth, with_depth)});
}

}  // namespace

void to_json(nlohmann::json& json, const Finding& finding) {
  json = {{"about", finding.about}, {"sentence", finding.sentence}};
}

std::vector<Finding> look_over(const FrameSource& source) {
  std::vector<Finding> findings;
  check_gaps(source, findings);
  check_repeats(source, findings);
  return findings;
}

std::vector<Finding> check_frames(const FrameSource& source) {
  std::vector<Finding> findings;
  for (const std::string& warning : source.warnings()) findings.push_back({subject_of(warning), warning});
  for (Finding& finding : look_over(source)) findings.push_back(std::move(finding));
  return findings;
}

}  // namespace stillpoint
