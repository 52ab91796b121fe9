#include "core/sequence/image_survey.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <set>

#include "core/counted.hpp"

namespace stillpoint {
namespace {

constexpr std::uint16_t kNoMeasurement = 65535;  // raw: what some sensors store in place of 0
constexpr double kNearMedian = 0.45;  // m; a scene this near is doubted when its nearest part is nearer still
constexpr int kMaskHalf = 127;        // of 8 bits
constexpr double kWhiteShare = 0.5;   // of what is not 0, to call a mask black and white
constexpr int kMostLabels = 32;       // values: with more it is a picture and no labels
constexpr int kNearlyWhite = 250, kNearlyBlack = 5;  // of 8 bits: JPEG's white and black

double quantile(std::vector<float>& values, double share) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// An image as one channel: its alpha where that varies, for then it is what is cut out, whatever colours lie
/// under it; otherwise the largest of its colours.
cv::Mat strongest(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  std::vector<cv::Mat> channels;
  cv::split(image, channels);
  if (image.channels() == 4 || image.channels() == 2) {
    double least = 0, most = 0;
    cv::minMaxLoc(channels.back(), &least, &most);
    if (least < most) return channels.back();
    channels.pop_back();
  }
  cv::Mat result = channels[0];
  for (std::size_t i = 1; i < channels.size(); ++i) result = cv::max(result, channels[i]);
  return result;
}

/// Whether a mask image has colours, and not by the noise of its compression.
bool is_coloured(const cv::Mat& image) {
  constexpr int kGray = 40;             // of 8 bits: what compression makes of grey edges stays within it
  constexpr double kLeastShare = 1e-3;  // of the pixels
  if (image.channels() < 3) return false;
  std::vector<cv::Mat> channels;
  cv::split(to_8bit(image), channels);
  const cv::Mat most = cv::max(cv::max(channels[0], channels[1]), channels[2]),
                least = cv::min(cv::min(channels[0], channels[1]), channels[2]);
  return cv::countNonZero(most - least > kGray) > kLeastShare * static_cast<double>(image.total());
}

bool is_floating(const cv::Mat& image) { return image.depth() == CV_32F || image.depth() == CV_64F; }

/// What white is, of a mask's type: 255, 65535 or 1; in steps of 8 bits.
double step_of(const cv::Mat& mask) {
  return mask.depth() == CV_8U ? 1.0 : mask.depth() == CV_16U ? 257.0 : 1.0 / 255.0;
}

bool is_plausible(double nearest_m, double median_m, double farthest_m) {
  return !(median_m < kNearMedian && nearest_m < kNearestPlausible) && farthest_m <= kFarthestPlausible;
}

}  // namespace

std::string fault_of_depth(const std::string& path, const ImageRead& read, const DepthSize& expected) {
  const cv::Mat& image = read.image;
  if (image.type() != CV_16UC1 && !read.in_metres) {
    const bool is_float = image.depth() == CV_32F || image.depth() == CV_64F;
    return fmt::format("{} holds {} of {} bits{}, expected depth as 1 channel of 16 bits", path,
                       counted(image.channels(), "channel"), 8 * image.elemSize1(),
                       is_float ? " (floating point)" : "");
  }
  if (image.size() != expected.size)
    return fmt::format("{} is {}x{} px, but {} {}x{} px", path, image.cols, image.rows, expected.whose,
                       expected.size.width, expected.size.height);
  return {};
}

DepthSurvey survey_depth(const ImagePaths& paths, const DepthSize& expected, const ImageReader& read_image) {
  DepthSurvey survey;
  std::vector<float> values;
  double pixels = 0, zeros = 0;
  for (const std::string& path : paths) {
    ImageRead read = read_image(path);
    if (read.image.empty()) {
      if (survey.fault.empty() && read.is_other_format) survey.fault = read.problem;
      survey.read += read.is_other_format ? 1 : 0;
      continue;
    }
    // An image tool may write a frame without any depth in another kind.
    if (cv::countNonZero(strongest(read.image)) == 0) continue;
    ++survey.read;
    if (const std::string fault = fault_of_depth(path, read, expected); !fault.empty()) {
      if (survey.fault.empty()) survey.fault = fault, survey.other_size = read.image.size() != expected.size;
      continue;
    }
    ++survey.fit;
    survey.in_metres = read.in_metres;
    const auto of_image = [&read](int y, int x) {
      if (read.in_metres) return read.image.at<float>(y, x) * static_cast<float>(kMetresSurveyScale);
      const auto raw = read.image.at<std::uint16_t>(y, x);
      return raw == kNoMeasurement ? 0.0F : static_cast<float>(raw);
    };
    constexpr int kStride = 3;  // px: a ninth of the pixels tells quantiles as well
    for (int y = 0; y < read.image.rows; y += kStride)
      for (int x = 0; x < read.image.cols; x += kStride) {
        const float value = of_image(y, x);
        pixels += 1, zeros += value == 0 ? 1 : 0;
        if (value != 0) values.push_back(value);
      }
  }
  survey.nearest = quantile(values, 0.02);
  survey.median = quantile(values, 0.5);
  survey.farthest = quantile(values, 0.98);
  survey.zeros = pixels > 0 ? zeros / pixels : 0.0;
  return survey;
}

std::optional<ScaleDoubt> doubt_scale(const DepthSurvey& survey, double scale) {
  if (survey.median <= 0) return std::nullopt;
  const auto plausible = [&](double s) {
    return is_plausible(survey.nearest / s, survey.median / s, survey.farthest / s);
  };
  if (plausible(scale)) return std::nullopt;
  ScaleDoubt doubt{survey.nearest / scale, survey.median / scale, survey.farthest / scale, {}};
  for (const double usual : {1000.0, 5000.0, 10000.0, 256.0})
    if (!doubt.likely_scale && plausible(usual)) doubt.likely_scale = usual;
  return doubt;
}

MaskSurvey survey_masks(const ImagePaths& paths, const ImageReader& read_image) {
  MaskSurvey survey;
  std::vector<cv::Mat> images;
  double white = 0, black = 0, nonzero = 0, half_of_range = kMaskHalf;
  std::set<int> labels;
  bool probabilities = true;
  for (const std::string& path : paths) {
    const ImageRead read = read_image(path);
    if (read.image.empty()) continue;
    const cv::Mat mask = strongest(read.image);
    if (survey.read++ == 0) survey.size = mask.size();
    const double range = step_of(mask);
    half_of_range = kMaskHalf * range;
    double largest = 0;
    cv::minMaxLoc(mask, nullptr, &largest);
    survey.largest = std::max(survey.largest, largest);
    nonzero += cv::countNonZero(mask);
    white += cv::countNonZero(mask >= kNearlyWhite * range);
    black += cv::countNonZero(mask) - cv::countNonZero(mask > kNearlyBlack * range);
    survey.coloured = survey.coloured || is_coloured(read.image);
    cv::Mat values;
    mask.convertTo(values, CV_32S);
    probabilities = probabilities && is_floating(mask) && largest <= 1.0;
    for (int y = 0; y < values.rows; y += 4)
      for (int x = 0; x < values.cols; x += 4)
        if (values.at<int>(y, x) != 0 && labels.size() < 1000) labels.insert(values.at<int>(y, x));
    images.push_back(mask);
  }
  survey.labels = static_cast<int>(labels.size());
  // Nothing bright, or a few values of which white is not the most: 0 and 1, or labels of things. A black and
  // white mask may have grey edges, and one of probabilities has many values.
  const bool dark = nonzero > 0 && survey.largest <= half_of_range;
  const bool labelled = survey.labels > 1 && survey.labels <= kMostLabels && white < kWhiteShare * nonzero;
  survey.coding = !probabilities && (dark || labelled) ? MaskCoding::nonzero : MaskCoding::bright;
  survey.gray_share = nonzero > black ? (nonzero - black - white) / (nonzero - black) : 0.0;
  double moving = 0, pixels = 0;
  for (const cv::Mat& image : images) {
    moving += cv::countNonZero(moving_pixels(image, survey.coding));
    pixels += static_cast<double>(image.total());
  }
  survey.moving_share = pixels > 0 ? moving / pixels : 0.0;
  return survey;
}

std::string how_read(const MaskSurvey& survey, const std::string& become) {
  constexpr double kMostEdges = 0.4;  // of what is not black: edges that are smoothed are less
  if (survey.coding == MaskCoding::nonzero)
    return survey.labels > 1
               ? fmt::format("the masks hold {} labels; whatever is not 0 is {}", survey.labels, become)
               : fmt::format("the masks hold 0 and {:g}; what is {:g} is {}", survey.largest, survey.largest,
                             become);
  if (survey.coloured)
    return fmt::format("the masks are coloured; what is bright in one of its colours is {}", become);
  if (survey.gray_share > kMostEdges)
    return fmt::format("{:.0f} % of what is not black in the masks is grey; what is brighter than half is {}",
                       100.0 * survey.gray_share, become);
  return {};
}

cv::Mat moving_pixels(const cv::Mat& image, MaskCoding coding) {
  const cv::Mat mask = strongest(image);
  if (coding == MaskCoding::nonzero) return mask != 0;
  return mask > (kMaskHalf + 0.5) * step_of(mask);
}

}  // namespace stillpoint
