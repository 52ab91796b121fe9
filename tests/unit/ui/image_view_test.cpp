#include "ui/view/image_view.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "ui/view/image_widget.hpp"

namespace stillpoint {
namespace {

const Eigen::Vector2d kImage{640.0, 480.0};
const Eigen::Vector2d kPanel{800.0, 480.0};

TEST(ImageMapTest, FitsWholeImageInTheMiddle) {
  const ImageMap map({}, kImage, kPanel);
  EXPECT_DOUBLE_EQ(map.scale(), 1.0);
  EXPECT_TRUE(map.to_panel(RasterPoint(0.0, 0.0)).isApprox(Eigen::Vector2d(80.0, 0.0)));
  EXPECT_TRUE(map.to_panel(RasterPoint(kImage)).isApprox(Eigen::Vector2d(720.0, 480.0)));
}

TEST(ImageMapTest, RoundTrips) {
  const ImageView view{{0.3, 0.8}, 7.3};
  const ImageMap map(view, kImage, kPanel);
  for (const Eigen::Vector2d& point :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(12.5, 479.9), Eigen::Vector2d(-8, 700)}) {
    EXPECT_TRUE(map.to_image(map.to_panel(RasterPoint(point))).px().isApprox(point, 1e-12));
  }
}

TEST(ImageMapTest, PixelUnderThePoint) {
  const ImageMap map({}, kImage, kPanel);
  EXPECT_EQ(map.pixel_at({80.0, 0.0}), Eigen::Vector2i(0, 0));
  EXPECT_EQ(map.pixel_at({81.99, 1.0}), Eigen::Vector2i(1, 1));
  EXPECT_EQ(map.pixel_at({719.9, 479.9}), Eigen::Vector2i(639, 479));
  EXPECT_EQ(map.pixel_at({79.9, 10.0}), std::nullopt);
  EXPECT_EQ(map.pixel_at({720.1, 10.0}), std::nullopt);
}

TEST(ImageViewTest, ZoomKeepsThePointUnderTheCursor) {
  ImageView view;
  const Eigen::Vector2d cursor{300.0, 200.0};
  for (const double factor : {1.2, 3.0, 0.7, 2.0}) {
    const Eigen::Vector2d before = ImageMap(view, kImage, kPanel).to_image(cursor).px();
    zoom_about(view, kImage, kPanel, cursor, factor);
    EXPECT_TRUE(ImageMap(view, kImage, kPanel).to_image(cursor).px().isApprox(before, 1e-9));
  }
}

TEST(ImageViewTest, ZoomHasEnds) {
  ImageView view;
  for (int i = 0; i < 100; ++i) zoom_about(view, kImage, kPanel, {400.0, 240.0}, 1.5);
  EXPECT_DOUBLE_EQ(ImageMap(view, kImage, kPanel).scale(), 256.0);
  for (int i = 0; i < 100; ++i) zoom_about(view, kImage, kPanel, {400.0, 240.0}, 0.5);
  EXPECT_DOUBLE_EQ(view.zoom, 0.25);
}

TEST(ImageViewTest, PanFollowsTheMouseAndStopsAtTheImagesEdge) {
  ImageView view{{0.5, 0.5}, 4.0};
  const Eigen::Vector2d before = ImageMap(view, kImage, kPanel).to_panel(RasterPoint(100.0, 100.0));
  pan_by(view, kImage, kPanel, {30.0, -20.0});
  EXPECT_TRUE(ImageMap(view, kImage, kPanel)
                  .to_panel(RasterPoint(100.0, 100.0))
                  .isApprox(before + Eigen::Vector2d(30.0, -20.0)));
  pan_by(view, kImage, kPanel, {1e6, 1e6});
  EXPECT_EQ(view.centre, Eigen::Vector2d(0.0, 0.0));
}

TEST(ImageViewTest, SetScaleShowsPixelsAsTheyAre) {
  ImageView view;
  set_scale(view, kImage, {1600.0, 960.0}, 1.0);
  EXPECT_DOUBLE_EQ(ImageMap(view, kImage, {1600.0, 960.0}).scale(), 1.0);
}

TEST(ImageViewTest, RevealMovesNoMoreThanNeeded) {
  ImageView view{{0.5, 0.5}, 4.0};
  const ImageView seen = view;
  reveal(view, kImage, kPanel, RasterPoint(320.0, 240.0));
  EXPECT_EQ(view, seen);
  reveal(view, kImage, kPanel, RasterPoint(600.0, 240.0));
  EXPECT_NEAR(ImageMap(view, kImage, kPanel).to_panel(RasterPoint(600.0, 240.0)).x(), kPanel.x(), 1e-9);
}

TEST(ImageViewTest, OneViewServesImagesOfDifferentSize) {
  const ImageView view{{0.25, 0.75}, 5.0};
  const ImageMap large(view, kImage, kPanel), small(view, kImage / 2.0, kPanel);
  EXPECT_TRUE(large.to_image({10.0, 20.0}).px().isApprox(2.0 * small.to_image({10.0, 20.0}).px()));
}

TEST(ImageViewTest, AnEmptyImageOrPanelDoesNoHarm) {
  const ImageMap map({}, {0.0, 0.0}, {0.0, 0.0});
  EXPECT_TRUE(map.to_panel(RasterPoint(0.5, 0.5)).allFinite());
}

TEST(LinkedViewsTest, PanelsOfOneKeyShareOneView) {
  LinkedViews views;
  views.at("images").zoom = 3.0;
  EXPECT_EQ(views.at("images").zoom, 3.0);
  EXPECT_EQ(views.at("depth").zoom, 1.0);
}

TEST(PixelTextTest, ReadsRedGreenBlue) {
  const cv::Mat colour(1, 1, CV_8UC3, cv::Scalar(10, 20, 30));
  EXPECT_EQ(pixel_text(colour, 0, 0), "30\n20\n10");
  EXPECT_EQ(pixel_text(cv::Mat(1, 1, CV_16UC1, cv::Scalar(5000)), 0, 0), "5000");
  EXPECT_EQ(pixel_text(cv::Mat(1, 1, CV_32FC1, cv::Scalar(0.25)), 0, 0), "0.25");
  EXPECT_EQ(pixel_text(cv::Mat(1, 1, CV_16SC1, cv::Scalar(-7)), 0, 0), "-7");
}

}  // namespace
}  // namespace stillpoint
