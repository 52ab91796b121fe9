// The two conventions of where a pixel lies: values worked out by hand, and that they do not mix.
#include "core/geometry/pixel_conventions.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <type_traits>

#include "core/geometry/camera.hpp"

namespace stillpoint {
namespace {

// What is taken for the other kind, or reckoned with it, does not compile.
template <typename From, typename To>
constexpr bool kMixes = std::is_convertible_v<From, To>;
static_assert(!kMixes<double, RasterCoordinate<double>> && !kMixes<RasterCoordinate<double>, double>);
static_assert(!kMixes<float, RasterCoordinate<float>> && !kMixes<RasterCoordinate<float>, float>);
static_assert(!kMixes<RasterCoordinate<float>, RasterCoordinate<double>>);
static_assert(!kMixes<Eigen::Vector2d, RasterPoint> && !kMixes<RasterPoint, Eigen::Vector2d>);
static_assert(!kMixes<Eigen::Vector2i, RasterPoint> && !kMixes<RasterPoint, Eigen::Vector2i>);
static_assert(!kMixes<cv::Point2f, RasterPoint> && !kMixes<RasterPoint, cv::Point2f>);
static_assert(!kMixes<cv::Point2d, RasterPoint> && !kMixes<RasterPoint, cv::Point2d>);
static_assert(!kMixes<cv::Point, RasterPoint> && !kMixes<RasterPoint, cv::Point>);

// Nor does a bare pair of numbers, which says of neither what it is.
struct TakesRaster {
  void operator()(const RasterPoint& point) const;
};
template <typename... Numbers>
concept PassesAsRaster = requires(Numbers... numbers) {
  TakesRaster{}({numbers...});
};
static_assert(!PassesAsRaster<double, double> && !PassesAsRaster<int, int>);
static_assert(!PassesAsRaster<Eigen::Vector2d> && !PassesAsRaster<cv::Point2f>);
static_assert(PassesAsRaster<RasterPoint>);

template <typename A, typename B>
concept Subtracts = requires(A a, B b) {
  a - b;
};
template <typename A, typename B>
concept Adds = requires(A a, B b) {
  a + b;
};
static_assert(!Subtracts<RasterCoordinate<double>, double> && !Subtracts<double, RasterCoordinate<double>>);
static_assert(!Adds<RasterCoordinate<double>, double> && !Adds<double, RasterCoordinate<double>>);
static_assert(!Subtracts<RasterPoint, double> && !Adds<RasterPoint, double>);
static_assert(!Subtracts<RasterPoint, Eigen::Vector2d> && !Subtracts<Eigen::Vector2d, RasterPoint>);
static_assert(!Subtracts<RasterPoint, cv::Point2f> && !Adds<RasterPoint, cv::Point2f>);

// A camera's functions are of pixel coordinates.
template <typename T>
concept BackProjects = requires(Camera camera, T pixel) {
  camera.back_project(pixel, 1.0);
};
static_assert(BackProjects<Eigen::Vector2d> && !BackProjects<RasterPoint>);
template <typename T>
concept Upsamples = requires(T place) {
  upsampled(place, 2.0F);
};
static_assert(Upsamples<float> && Upsamples<cv::Point2f> && Upsamples<Eigen::Vector2d>);
static_assert(!Upsamples<RasterCoordinate<float>> && !Upsamples<RasterPoint>);

static_assert(to_raster(0.0).px() == 0.5 && to_raster(7.0F).px() == 7.5F);
static_assert(to_pixel(RasterCoordinate(0.0)) == -0.5 && to_pixel(RasterCoordinate(640.0F)) == 639.5F);
static_assert(upsampled(0.0, 4.0) == 1.5 && downsampled(1.5, 4.0) == 0.0);

TEST(PixelConventions, APixelsCentreLiesHalfAPixelIntoItsRaster) {
  EXPECT_EQ(to_raster(Eigen::Vector2d(3.0, -1.0)).px(), Eigen::Vector2d(3.5, -0.5));
  EXPECT_EQ(to_raster(cv::Point2f(3.25F, 8.0F)).px(), Eigen::Vector2d(3.75, 8.5));
  EXPECT_EQ(to_pixel(RasterPoint(0.0, 480.0)), Eigen::Vector2d(-0.5, 479.5));
  const Eigen::Vector2d there = to_pixel(to_raster(Eigen::Vector2d(12.25, 7.75)));
  EXPECT_EQ(there, Eigen::Vector2d(12.25, 7.75));
}

TEST(PixelConventions, APixelCoversItsRasterSquareWithoutTheFarSides) {
  EXPECT_EQ(pixel_covering(RasterPoint(0.0, 0.0)), Eigen::Vector2i(0, 0));
  EXPECT_EQ(pixel_covering(RasterPoint(0.999, 1.0)), Eigen::Vector2i(0, 1));
  EXPECT_EQ(pixel_covering(RasterPoint(-0.001, 2.5)), Eigen::Vector2i(-1, 2));
  EXPECT_EQ(pixel_covering(to_raster(Eigen::Vector2d(4.49, 4.51))), Eigen::Vector2i(4, 5));
}

TEST(PixelConventions, ADownsampledPixelsCentreIsTheMiddleOfItsBlock) {
  // Block 3 of four pixels is of pixels 12 to 15.
  EXPECT_EQ(upsampled(3.0, 4.0), (12 + 13 + 14 + 15) / 4.0);
  EXPECT_EQ(upsampled(cv::Point2f(3.0F, 0.0F), 4.0F), cv::Point2f(13.5F, 1.5F));
  EXPECT_EQ(upsampled(Eigen::Vector2d(3.0, 0.0), 3.0), Eigen::Vector2d(10.0, 1.0));
  EXPECT_EQ(downsampled(13.5F, 4.0F), 3.0F);
  EXPECT_EQ(downsampled(Eigen::Vector2d(10.0, 1.0), 3.0), Eigen::Vector2d(3.0, 0.0));
  EXPECT_EQ(downsampled(cv::Point2f(13.5F, 1.5F), 4.0F), cv::Point2f(3.0F, 0.0F));
}

TEST(PixelConventions, OpenCVMakesImagesSmallerInTheSameConvention) {
  // A ramp's mean over a block is its value at the block's middle.
  cv::Mat ramp(8, 16, CV_32FC1), small;
  for (int y = 0; y < ramp.rows; ++y)
    for (int x = 0; x < ramp.cols; ++x) ramp.at<float>(y, x) = static_cast<float>(3 * x + y);
  cv::resize(ramp, small, {4, 2}, 0, 0, cv::INTER_AREA);
  for (int y = 0; y < small.rows; ++y)
    for (int x = 0; x < small.cols; ++x)
      EXPECT_EQ(static_cast<double>(small.at<float>(y, x)),
                3 * upsampled(static_cast<double>(x), 4.0) + upsampled(static_cast<double>(y), 4.0));
}

TEST(PixelConventions, AScaledCameraSeesAPointInTheSamePlaceOfItsImage) {
  const Camera full = camera_by_name("freiburg3"), small = full.scaled_to(full.width / 4, full.height / 4);
  const Eigen::Vector3d point(0.3, -0.2, 2.0);
  EXPECT_TRUE(upsampled(small.project(point), 4.0).isApprox(full.project(point), 1e-12));
  EXPECT_TRUE(
      to_raster(small.project(point)).px().isApprox((to_raster(full.project(point)) / 4.0).px(), 1e-12));
}

TEST(PixelConventions, RowsOfAReadoutAreSharedOutEvenlyAboutTheMiddle) {
  Camera camera;
  camera.height = 480, camera.readout_s = 0.048;
  EXPECT_EQ(camera.middle_row(), 239.5);
  EXPECT_EQ(camera.row_time(camera.middle_row()), 0.0);
  EXPECT_NEAR(camera.row_time(240.0) - camera.row_time(239.0), 0.0001, 1e-15);
  EXPECT_DOUBLE_EQ(camera.row_share(to_pixel(RasterCoordinate(0.0))), -0.5);
  EXPECT_DOUBLE_EQ(camera.row_share(to_pixel(RasterCoordinate(480.0))), 0.5);
}

}  // namespace
}  // namespace stillpoint
