// Small views and their superpixels of surface.
#include "core/motion/stillpoint/superpixels.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "core/motion/stillpoint/depth_evidence.hpp"
#include "core/motion/stillpoint/depth_warp.hpp"
#include "tests/support/board_scene.hpp"

namespace stillpoint {
namespace {

TEST(Superpixels, NeverCrossADepthEdge) {
  const RgbdView view = BoardScene{}.view();
  const auto [labels, superpixels, adjacency] = make_superpixels(view, {});
  std::vector<std::pair<float, float>> range(superpixels.size(), {1e9F, 0.0F});
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x)
      if (const int l = labels.at<int>(y, x); l >= 0) {
        auto& r = range[static_cast<std::size_t>(l)];
        r.first = std::min(r.first, view.depth.at<float>(y, x));
        r.second = std::max(r.second, view.depth.at<float>(y, x));
      }
  int with_pixels = 0;
  for (const auto& r : range)
    if (r.second > 0) {
      EXPECT_LT(r.second - r.first, 0.5F);
      ++with_pixels;
    }
  EXPECT_GE(with_pixels, 10);
  // The scene has an edge to cross.
  double nearest = 0.0, farthest = 0.0;
  cv::minMaxLoc(view.depth, &nearest, &farthest, nullptr, nullptr, view.depth > 0);
  EXPECT_GT(farthest - nearest, 0.5);
}

/// All pairs that touch, found the plain way, and their boundaries.
std::map<std::pair<int, int>, int> adjacency_by_hand(const RgbdView& view, const cv::Mat& labels) {
  std::map<std::pair<int, int>, int> found;
  const auto look = [&](const cv::Point& p, const cv::Point& q) {
    const int a = labels.at<int>(p), b = labels.at<int>(q);
    const bool touch =
        a >= 0 && b >= 0 && a != b && same_surface(view.depth.at<float>(p), view.depth.at<float>(q));
    if (touch) ++found[std::minmax(a, b)];
  };
  for (int y = 0; y < labels.rows; ++y)
    for (int x = 0; x < labels.cols; ++x) {
      if (x + 1 < labels.cols) look({x, y}, {x + 1, y});
      if (y + 1 < labels.rows) look({x, y}, {x, y + 1});
    }
  return found;
}

TEST(Superpixels, AdjacencyEdgesAreAllPairsThatTouchOnASurface) {
  cv::Mat gray, depth;
  BoardScene{}.render(gray, depth);
  // Whole superpixels and cut ones at the last rows and columns, down to one superpixel a side.
  for (const cv::Size& size : {cv::Size(640, 480), cv::Size(628, 452), cv::Size(60, 480)})
    for (const int side : {7, 10, 13, 64, 100}) {
      SCOPED_TRACE(testing::Message() << size << " by " << side);
      const cv::Rect part({0, 0}, size);
      const RgbdView view = make_rgbd_view(gray(part), depth(part), board_camera(), 4);
      StillpointConfig config;
      config.superpixel_px = side;
      const auto [labels, superpixels, adjacency] = make_superpixels(view, config);
      const auto expected = adjacency_by_hand(view, labels);
      ASSERT_EQ(adjacency.size(), expected.size());
      auto edge = adjacency.begin();
      for (const auto& [pair, boundary] : expected) {
        EXPECT_EQ(std::make_pair(edge->a, edge->b), pair);
        EXPECT_EQ(edge->boundary, boundary);
        ++edge;
      }
      if (side <= 13) {
        EXPECT_GT(expected.size(), 0U);
        EXPECT_GE(expected.size() + 1, superpixels.size()) << "one column at the least hangs together";
      }
    }
}

TEST(Superpixels, AreTheSameByWideLanes) {
  if (!has_wide_lanes()) GTEST_SKIP() << "this processor has no wide lanes";
  cv::Mat gray, depth;
  BoardScene{}.render(gray, depth);
  cv::Mat noise(depth.size(), CV_32FC1);
  cv::RNG random(8);
  random.fill(noise, cv::RNG::NORMAL, 0.0, 0.03);
  depth += noise;
  depth(cv::Rect(100, 90, 80, 50)) = 0.0F;
  for (const cv::Size& size : {cv::Size(640, 480), cv::Size(628, 452), cv::Size(61, 480), cv::Size(9, 30)})
    for (const int side : {4, 10, 13}) {
      SCOPED_TRACE(::testing::Message() << size << " by " << side);
      const cv::Rect part({0, 0}, size);
      const RgbdView view = make_rgbd_view(gray(part), depth(part), board_camera(), 4, false),
                     wide_view = make_rgbd_view(gray(part), depth(part), board_camera(), 4, true);
      EXPECT_EQ(cv::norm(view.gray, wide_view.gray, cv::NORM_INF), 0.0);
      StillpointConfig config;
      config.superpixel_px = side;
      const Superpixels plain = make_superpixels(view, config, false),
                        wide = make_superpixels(view, config, true);
      EXPECT_EQ(cv::norm(plain.labels, wide.labels, cv::NORM_INF), 0.0);
      ASSERT_EQ(plain.all.size(), wide.all.size());
      for (std::size_t i = 0; i < plain.all.size(); ++i) {
        EXPECT_EQ(plain.all[i].centre, wide.all[i].centre);
        EXPECT_EQ(plain.all[i].depth, wide.all[i].depth);
        EXPECT_EQ(plain.all[i].pixels, wide.all[i].pixels);
      }
    }
}

/// Bit by bit, so that what is unknown equals what is.
bool same_bits(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && a.isContinuous() && b.isContinuous() &&
         std::memcmp(a.data, b.data, a.total() * a.elemSize()) == 0;
}

/// The board moved, the camera moved and turned a little, and depth is noisy; widths about the lanes.
TEST(DepthEvidence, IsTheSameByWideLanes) {
  if (!has_wide_lanes()) GTEST_SKIP() << "this processor has no wide lanes";
  cv::RNG random(10);
  const auto view_of = [&](const BoardScene& scene, const cv::Size& size) {
    cv::Mat gray, depth;
    scene.render(gray, depth);
    cv::Mat noise(depth.size(), CV_32FC1);
    random.fill(noise, cv::RNG::NORMAL, 0.0, 0.01);
    depth += noise;
    depth(cv::Rect(30, 90, 80, 50)) = 0.0F;
    const cv::Rect part({0, 0}, size);
    Camera camera = board_camera();
    camera.width = size.width, camera.height = size.height;
    return std::make_shared<const RgbdView>(make_rgbd_view(gray(part), depth(part), camera, 4));
  };
  for (const cv::Size& size : {cv::Size(640, 480), cv::Size(500, 300), cv::Size(24, 40)})
    for (const bool old : {false, true}) {
      SCOPED_TRACE(::testing::Message() << size << (old ? " old" : ""));
      const auto now = view_of({0.06, 0.30}, size), then = view_of({0.0, 0.22, 1.1}, size);
      Pose then_from_now = Pose::Identity();
      then_from_now.translation() = Eigen::Vector3d(0.06, 0.002, -0.01);
      then_from_now.rotate(Eigen::AngleAxisd(0.004, Eigen::Vector3d::UnitZ()));
      ReferenceView reference;
      reference.view = then, reference.reference_from_current = then_from_now, reference.old = old;
      const cv::Mat prior = cv::Mat::zeros(now->depth.size(), CV_32FC1);
      const ReferenceEvidence plain = compare_with_reference(*now, reference, prior, {}, false),
                              wide = compare_with_reference(*now, reference, prior, {}, true);
      EXPECT_EQ(plain.registration_error_px, wide.registration_error_px);
      EXPECT_EQ(plain.intensity_sigma, wide.intensity_sigma);
      EXPECT_TRUE(same_bits(plain.depth_residual, wide.depth_residual));
      EXPECT_TRUE(same_bits(plain.intensity_residual, wide.intensity_residual));
      EXPECT_TRUE(same_bits(plain.log_odds, wide.log_odds));
      if (size.width == 640) {
        EXPECT_GT(cv::countNonZero(plain.log_odds > 0), 100) << "some is seen to move";
        EXPECT_GT(cv::countNonZero(plain.log_odds < 0), 1000) << "and most not to";
      }
      DepthWarp by_few(now->camera, then_from_now, false), by_many(now->camera, then_from_now, true);
      std::vector<float> sampled_by_few, sampled_by_many;
      int inside = 0;
      for (int y = 0; y < now->depth.rows; ++y) {
        by_few.warp_row(y, now->depth.ptr<float>(y)), by_many.warp_row(y, now->depth.ptr<float>(y));
        by_few.sample_row(then->gray, sampled_by_few), by_many.sample_row(then->gray, sampled_by_many);
        for (int x = 0; x < now->depth.cols; ++x) {
          ASSERT_EQ(by_few.inside(x), by_many.inside(x));
          if (!by_few.inside(x)) continue;
          ++inside;
          const auto at = static_cast<std::size_t>(x);
          ASSERT_EQ(by_few.nearest(x), by_many.nearest(x));
          ASSERT_EQ(by_few.z(x), by_many.z(x));
          ASSERT_EQ(sampled_by_few[at], sampled_by_many[at]);
        }
      }
      EXPECT_GT(inside, 0);

      MotionPrior before{then, cv::Mat(then->depth.size(), CV_32FC1)};
      random.fill(before.log_odds, cv::RNG::UNIFORM, -3.0, 4.0);
      const WarpedPrior warped_plain = warp_prior(*now, before, then_from_now, {}, false),
                        warped_wide = warp_prior(*now, before, then_from_now, {}, true);
      EXPECT_TRUE(same_bits(warped_plain.log_odds, warped_wide.log_odds));
      EXPECT_TRUE(same_bits(warped_plain.newly_observed, warped_wide.newly_observed));
      EXPECT_GT(cv::countNonZero(warped_plain.log_odds), 0);
      EXPECT_GT(cv::countNonZero(warped_plain.newly_observed), 0) << "the image's rim came into view";
    }
}

TEST(RgbdView, BlocksAreAveragedAlikeByWideLanes) {
  if (!has_wide_lanes()) GTEST_SKIP() << "this processor has no wide lanes";
  cv::Mat gray(64, 96, CV_8UC1), expected;
  cv::RNG random(9);
  random.fill(gray, cv::RNG::UNIFORM, 0, 256);
  gray.row(3) = 255, gray.row(2) = 255, gray.row(1) = 255, gray.row(0) = 255;
  cv::resize(gray, expected, {24, 16}, 0, 0, cv::INTER_AREA);
  expected.convertTo(expected, CV_32F);
  EXPECT_EQ(cv::norm(make_rgbd_view(gray, {}, board_camera(), 4, true).gray, expected, cv::NORM_INF), 0.0);
}

TEST(Superpixels, EvenTheSmallestViewHasAPatch) {
  for (const cv::Size& size : {cv::Size(1, 1), cv::Size(3, 2), cv::Size(13, 5), cv::Size(40, 3)}) {
    const cv::Mat gray(size, CV_8UC1, cv::Scalar(90)), depth(size, CV_32FC1, cv::Scalar(1.5F));
    const RgbdView view = make_rgbd_view(gray, depth, board_camera(), 4);
    ASSERT_FALSE(view.depth.empty()) << size;
    EXPECT_EQ(cv::norm(view.depth, cv::Mat(view.depth.size(), CV_32FC1, cv::Scalar(1.5F)), cv::NORM_INF),
              0.0);
    const auto [labels, superpixels, adjacency] = make_superpixels(view, {});
    ASSERT_FALSE(superpixels.empty()) << size;
    EXPECT_EQ(cv::countNonZero(labels < 0), 0) << size;
    EXPECT_EQ(enlarged(view.depth > 1.0F, 4, size).size(), size);
  }
}

TEST(RgbdView, ASmallMaskIsEnlargedByBlocks) {
  const cv::Mat small = (cv::Mat_<uchar>(2, 3) << 255, 0, 255, 0, 255, 0);
  const cv::Mat full = enlarged(small, 4, {14, 9});  // 2 columns and a row that no block covers
  ASSERT_EQ(full.size(), cv::Size(14, 9));
  for (int y = 0; y < full.rows; ++y)
    for (int x = 0; x < full.cols; ++x)
      EXPECT_EQ(full.at<uchar>(y, x), small.at<uchar>(std::min(y / 4, 1), std::min(x / 4, 2)));
}

}  // namespace
}  // namespace stillpoint
