#include "tests/support/golden.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <string_view>

#include "tests/support/places.hpp"

namespace stillpoint::testing {
namespace {

/// Per pixel the largest difference of a channel, 8UC1.
cv::Mat largest_difference(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  std::vector<cv::Mat> channels;
  cv::split(difference, channels);
  cv::Mat largest = channels[0];
  for (const cv::Mat& channel : channels) cv::max(largest, channel, largest);
  return largest;
}

bool wants_update() {
  const char* update = std::getenv("STILLPOINT_UPDATE_GOLDEN");
  return update != nullptr && std::string_view(update) == "1";
}

::testing::AssertionResult compare_with_golden(
    const cv::Mat& actual, const std::string& name,
    const std::function<::testing::AssertionResult(const cv::Mat& expected)>& compare) {
  const std::filesystem::path golden =
      std::filesystem::path(places::source()) / "tests/golden" / (name + ".png");
  if (wants_update()) {
    std::filesystem::create_directories(golden.parent_path());
    // Golden images are kept in the repository, so they are packed as small as PNG goes.
    if (!cv::imwrite(golden.string(), actual, {cv::IMWRITE_PNG_COMPRESSION, 9}))
      return ::testing::AssertionFailure() << "cannot write " << golden;
    return ::testing::AssertionSuccess();
  }
  const cv::Mat expected = cv::imread(golden.string(), cv::IMREAD_COLOR);
  ::testing::AssertionResult result =
      expected.empty()
          ? ::testing::AssertionFailure() << golden << " is missing; STILLPOINT_UPDATE_GOLDEN=1 writes it"
          : compare(expected);
  if (result) return result;
  const std::filesystem::path place = std::filesystem::path(places::output()) / name;
  std::filesystem::create_directories(place.parent_path());
  cv::imwrite(place.string() + ".actual.png", actual);
  if (expected.size() == actual.size() && expected.type() == actual.type()) {
    cv::imwrite(place.string() + ".diff.png", largest_difference(actual, expected) * 8);
  }
  return result << "; see " << place.string() << ".actual.png and .diff.png beside it";
}

}  // namespace

::testing::AssertionResult images_agree(const cv::Mat& actual, const cv::Mat& expected,
                                        const ImageTolerance& tolerance) {
  if (actual.size() != expected.size() || actual.type() != expected.type()) {
    return ::testing::AssertionFailure()
           << "images of " << actual.size() << " and " << expected.size() << " (types " << actual.type()
           << " and " << expected.type() << ") are not comparable";
  }
  const cv::Mat difference = largest_difference(actual, expected);
  const int beyond = cv::countNonZero(difference > tolerance.channel);
  const double allowed =
      std::max(tolerance.pixels, tolerance.pixels_share * static_cast<double>(actual.total()));
  if (beyond <= allowed) return ::testing::AssertionSuccess();
  double most = 0.0;
  cv::minMaxLoc(difference, nullptr, &most);
  return ::testing::AssertionFailure() << beyond << " pixels differ by more than " << tolerance.channel
                                       << " (at most " << allowed << " may), the worst by " << most;
}

::testing::AssertionResult images_agree_but_scene(const cv::Mat& actual, const cv::Mat& expected,
                                                  const cv::Rect& scene) {
  if (actual.size() != expected.size() || actual.type() != expected.type())
    return images_agree(actual, expected, kInterfaceTolerance);
  const cv::Rect part = scene & cv::Rect({0, 0}, actual.size());
  if (part.empty()) return ::testing::AssertionFailure() << "the scene lies outside the image: " << scene;
  cv::Mat actual_around = actual.clone(), expected_around = expected.clone();
  actual_around(part).setTo(cv::Scalar::all(0));
  expected_around(part).setTo(cv::Scalar::all(0));
  ::testing::AssertionResult around = images_agree(actual_around, expected_around, kInterfaceTolerance);
  if (!around) return around << " around the scene";
  ::testing::AssertionResult within = images_agree(actual(part), expected(part), kSceneTolerance);
  return within ? within : within << " in the scene";
}

::testing::AssertionResult matches_golden(const cv::Mat& actual, const std::string& name,
                                          const ImageTolerance& tolerance) {
  return compare_with_golden(
      actual, name, [&](const cv::Mat& expected) { return images_agree(actual, expected, tolerance); });
}

::testing::AssertionResult matches_golden_but_scene(const cv::Mat& actual, const std::string& name,
                                                    const cv::Rect& scene) {
  return compare_with_golden(
      actual, name, [&](const cv::Mat& expected) { return images_agree_but_scene(actual, expected, scene); });
}

bool is_blank(const cv::Mat& image, int colours) {
  std::set<int> seen;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const auto& bgr = image.at<cv::Vec3b>(y, x);
      seen.insert(bgr[0] | bgr[1] << 8 | bgr[2] << 16);
      if (static_cast<int>(seen.size()) >= colours) return false;
    }
  }
  return true;
}

}  // namespace stillpoint::testing
