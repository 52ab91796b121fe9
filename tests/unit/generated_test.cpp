#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "core/error.hpp"
#include "core/sequence/generated/act.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "core/sequence/generated/ray_caster.hpp"
#include "core/sequence/write_sequence.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

bool same(const Frame& a, const Frame& b) {
  return a.timestamp == b.timestamp && same(a.colour, b.colour) && same(a.gray, b.gray) &&
         same(a.depth, b.depth);
}

double share(const cv::Mat& mask) { return cv::countNonZero(mask) / static_cast<double>(mask.total()); }

std::string sentence_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// ---- what rays meet
// ------------------------------------------------------------------------------------------------

float depth_ahead(const generated::Primitive& primitive, const Eigen::Vector3f& from,
                  const Eigen::Vector3f& ray) {
  generated::Scene scene;
  scene.fixed.push_back(primitive);
  Camera camera;
  camera.width = camera.height = 1;
  camera.fx = camera.fy = 1;
  camera.cx = -static_cast<double>(ray.x()), camera.cy = -static_cast<double>(ray.y());
  generated::Instant instant;
  instant.world_from_camera.translation() = from.cast<double>();
  const float depth = generated::cast_depth(scene, camera, instant).depth.at<float>(0, 0);
  return depth < 1e8f ? depth : -1;
}

TEST(GeneratedPrimitives, AreMetWhereGeometrySays) {
  const Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();
  EXPECT_NEAR(depth_ahead(generated::make_ellipsoid({0, 0, 3}, {1, 1, 0.5f}, axes, 0), {0, 0, 0}, {0, 0, 1}),
              2.5f, 1e-5);
  EXPECT_NEAR(depth_ahead(generated::make_box({0, 0, 4}, {1, 1, 1}, axes, 0), {0, 0, 0}, {0.2f, 0, 1}), 3.0f,
              1e-5);
  EXPECT_EQ(depth_ahead(generated::make_box({0, 0, 4}, {1, 1, 1}, axes, 0), {0, 0, 0}, {0.5f, 0, 1}), -1);
  // A wheel seen from the side (its rim) and from the front (its cap).
  const auto wheel = generated::make_cylinder({0, 0, 2}, {0, 0, 2.4f}, 0.3f, 0);
  EXPECT_NEAR(depth_ahead(wheel, {0.1f, 0, 0}, {0, 0, 1}), 2.0f, 1e-5);
  EXPECT_NEAR(depth_ahead(generated::make_cylinder({0, -1, 2}, {0, 1, 2}, 0.3f, 0), {0, 0, 0}, {0, 0, 1}),
              1.7f, 1e-5);
}

TEST(GeneratedPrimitives, ConeTouchesBothSpheres) {
  // Spheres of 0.3 and 0.1 m, 1 m apart along y: sine 0.2, so at half height the side stands
  // 0.3 / cos - 0.5 tan = 0.20412 m from the axis.
  const auto cone = generated::make_cone({0, 0, 2}, 0.3f, {0, 1, 2}, 0.1f, 0);
  EXPECT_NEAR(depth_ahead(cone, {0, 0.5f, 0}, {0, 0, 1}), 2.0f - 0.20412f, 1e-4);
  EXPECT_NEAR(depth_ahead(cone, {0, -0.2f, 0}, {0, 0, 1}), 2.0f - std::sqrt(0.09f - 0.04f), 1e-4);
  EXPECT_NEAR(depth_ahead(cone, {0, 1.06f, 0}, {0, 0, 1}), 2.0f - 0.08f, 1e-4);
  EXPECT_EQ(depth_ahead(cone, {0, 1.11f, 0}, {0, 0, 1}), -1);
}

TEST(GeneratedPrimitives, AreTheSameToTheBitHoweverManyRaysAreCastAtOnce) {
  if (generated::most_lanes() == 4) GTEST_SKIP() << "this processor casts four";
  const generated::Act act = generated::make_act("walking_xyz", 3, 2.0);
  Camera camera = camera_by_name("generated").scaled_to(161, 119);  // the last rays of a row lie outside
  std::array<generated::Instant, 4> exposure;
  for (std::size_t k = 0; k < exposure.size(); ++k) {
    const double seconds = 1.0 + 0.004 * static_cast<double>(k);
    exposure[k].world_from_camera.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    exposure[k].world_from_camera.translation() << 0.2 * seconds, -1.5, 1.4;
    act.play(seconds, exposure[k]);
  }
  const auto cast = [&](int lanes) {
    return generated::cast_frame(act.scene, camera, exposure[2], exposure, 5.0, lanes);
  };
  const generated::Rendering four = cast(4), eight = cast(8);
  EXPECT_TRUE(same(four.colour, eight.colour));
  EXPECT_TRUE(same(four.depth, eight.depth));
  EXPECT_TRUE(same(four.id, eight.id));
}

// ---- the source
// ----------------------------------------------------------------------------------------------------

TEST(GeneratedSequence, KnowsTwelveKindsAndNamesThem) {
  EXPECT_EQ(generated_kinds().size(), 12u);
  const std::string sentence = sentence_of([] { (void)make_generated_sequence("dancing", 10, 1); });
  EXPECT_THAT(sentence, testing::HasSubstr("dancing"));
  for (const std::string& kind : generated_kinds()) EXPECT_THAT(sentence, testing::HasSubstr(kind));
}

TEST(GeneratedSequence, HasAsManyFramesAsAskedFor) {
  EXPECT_EQ(make_generated_sequence("room", 0, 1)->size(), 300);
  EXPECT_EQ(make_generated_sequence("room", 1, 1)->size(), 1);
  EXPECT_EQ(open_sequence("generated:room", {std::nullopt, 2, 1})->size(), 2);
  EXPECT_THROW((void)make_generated_sequence("room", -1, 1), InputError);
  EXPECT_THROW((void)make_generated_sequence("room", 1000000, 1), InputError);
}

TEST(GeneratedSequence, SameSeedGivesSameBytesWhateverTheLength) {
  const auto one = make_generated_sequence("walking_xyz", 20, 7),
             two = make_generated_sequence("walking_xyz", 90, 7);
  EXPECT_TRUE(same(one->read(12), two->read(12)));
  EXPECT_TRUE(same(one->truth(12).moving, two->truth(12).moving));
}

TEST(GeneratedSequence, OtherSeedsGiveOtherPicturesAndPaths) {
  const auto one = make_generated_sequence("walking_xyz", 5, 1),
             two = make_generated_sequence("walking_xyz", 5, 2);
  EXPECT_GT(cv::norm(one->read(3).gray, two->read(3).gray, cv::NORM_L1) / (640 * 480), 5.0);
  EXPECT_GT((one->truth(3).world_from_camera->translation() - two->truth(3).world_from_camera->translation())
                .norm(),
            1e-3);
}

TEST(GeneratedSequence, ThreadsDoNotChangeFrames) {
  const auto sequence = make_generated_sequence("sitting_rpy", 8, 3);
  std::array<Frame, 4> together;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] { together[static_cast<std::size_t>(i)] = sequence->read(2 * i); });
  for (std::thread& thread : threads) thread.join();
  for (int i = 3; i >= 0; --i)
    EXPECT_TRUE(same(together[static_cast<std::size_t>(i)], sequence->read(2 * i))) << i;
}

TEST(GeneratedSequence, FramesAreTexturedAndWellExposed) {
  for (const char* kind : {"room", "walking_rpy", "desk_with_person", "cup"}) {
    const Frame frame = make_generated_sequence(kind, 4, 1)->read(3);
    EXPECT_EQ(frame.gray.size(), cv::Size(640, 480));
    std::vector<cv::KeyPoint> corners;
    cv::FAST(frame.gray, corners, 20);
    EXPECT_GT(corners.size(), 600u) << kind;
    const double mean = cv::mean(frame.gray)[0];
    EXPECT_TRUE(mean > 70 && mean < 190) << kind << ' ' << mean;
    EXPECT_LT(share(frame.gray >= 255), 0.1) << kind;
  }
}

TEST(GeneratedSequence, DepthIsThatOfA16BitImageWithHoles) {
  const auto sequence = make_generated_sequence("sitting_static", 2, 1);
  const cv::Mat depth = sequence->read(1).depth;
  cv::Mat stored, back;
  depth.convertTo(stored, CV_16U, 5000);
  stored.convertTo(back, CV_32F, 1.0 / 5000);
  EXPECT_TRUE(same(depth, back));
  const double holes = share(depth == 0);
  EXPECT_TRUE(holes > 0.03 && holes < 0.35) << holes;
  double nearest = 0, farthest = 0;
  cv::minMaxLoc(depth, &nearest, &farthest, nullptr, nullptr, depth > 0);
  EXPECT_GT(nearest, 0.4);
  EXPECT_LT(farthest, 6.5);
}

// ---- the truth
// -----------------------------------------------------------------------------------------------------

struct Agreement {
  double depth = 0;  ///< share of points whose depth in the other frame is as predicted
  double grey = 0;   ///< mean absolute grey-level difference of those
  int points = 0;
};

/// Carries pixels of frame i outside of the masks into frame j with the given motion.
Agreement warp(const FrameSource& sequence, int i, int j, const Pose& j_from_i) {
  const Frame a = sequence.read(i), b = sequence.read(j);
  cv::Mat moving_a, moving_b;
  cv::dilate(sequence.truth(i).moving, moving_a, cv::Mat(), {-1, -1}, 4);
  cv::dilate(sequence.truth(j).moving, moving_b, cv::Mat(), {-1, -1}, 4);
  Agreement result;
  int agreeing = 0;
  for (int y = 20; y < 460; y += 5)
    for (int x = 20; x < 620; x += 5) {
      const float z = a.depth.at<float>(y, x);
      if (z == 0 || moving_a.at<std::uint8_t>(y, x) != 0) continue;
      const Eigen::Vector3d point = j_from_i * sequence.camera().back_project({x, y}, static_cast<double>(z));
      const Eigen::Vector2d pixel = sequence.camera().project(point);
      const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
      if (u < 0 || v < 0 || u >= 640 || v >= 480 || moving_b.at<std::uint8_t>(v, u) != 0) continue;
      const double found = static_cast<double>(b.depth.at<float>(v, u));
      if (found == 0) continue;
      ++result.points;
      // Noise of both frames (3 sigma) and their disparity steps.
      const double away = point.z() - 0.4;
      const double tolerance = 0.004 + 4.5 * (0.0012 + 0.0019 * away * away) + 0.0035 * point.z() * point.z();
      if (std::abs(found - point.z()) > tolerance) continue;
      ++agreeing;
      result.grey += std::abs(a.gray.at<std::uint8_t>(y, x) - b.gray.at<std::uint8_t>(v, u));
    }
  result.depth = agreeing / static_cast<double>(std::max(1, result.points));
  result.grey /= std::max(1, agreeing);
  return result;
}

class GeneratedTruth : public testing::TestWithParam<const char*> {};

TEST_P(GeneratedTruth, PosesCarryStaticDepthFromFrameToFrame) {
  const auto sequence = make_generated_sequence(GetParam(), 40, 5);
  const Pose j_from_i =
      sequence->truth(30).world_from_camera->inverse() * *sequence->truth(8).world_from_camera;
  const Agreement right = warp(*sequence, 8, 30, j_from_i);
  EXPECT_GT(right.points, 1500);
  EXPECT_GT(right.depth, 0.9);
  EXPECT_LT(right.grey, 16.0);
  // The check has teeth: with the motion turned round, it fails.
  EXPECT_LT(warp(*sequence, 8, 30, j_from_i.inverse()).depth, right.depth - 0.1);
}
INSTANTIATE_TEST_SUITE_P(Kinds, GeneratedTruth,
                         testing::Values("room", "walking_xyz", "walking_halfsphere", "sitting_rpy"));

TEST(GeneratedSequence, GroundTruthHoldsTheFramesPoses) {
  const auto sequence = make_generated_sequence("walking_rpy", 10, 1);
  const Trajectory& truth = sequence->ground_truth();
  EXPECT_GE(truth.size(), 30u);
  for (int i = 0; i < sequence->size(); ++i) {
    const auto between = interpolate(truth, sequence->timestamp(i), 0.02);
    ASSERT_TRUE(between) << i;
    const Pose off = between->inverse() * *sequence->truth(i).world_from_camera;
    EXPECT_LT(off.translation().norm(), 5e-5);  // m; poses come at 100 Hz
    EXPECT_LT(rotation_angle(off.linear()), 1e-4);
  }
}

TEST(GeneratedMasks, NothingMovesInTheRoom) {
  const auto sequence = make_generated_sequence("room", 100, 1);
  for (const int i : {0, 50, 99}) EXPECT_EQ(share(sequence->truth(i).moving), 0.0);
}

TEST(GeneratedMasks, WalkersCoverAFairShareAndMove) {
  const auto sequence = make_generated_sequence("walking_static", 0, 1);
  double sum = 0;
  int seen = 0, count = 0;
  cv::Mat last;
  for (int i = 0; i < 300; i += 20, ++count) {
    const cv::Mat mask = sequence->truth(i).moving;
    sum += share(mask);
    seen += share(mask) > 0.01;
    if (!last.empty() && i <= 100) {
      EXPECT_GT(share(mask != last), 0.01) << i;
    }
    last = mask;
  }
  EXPECT_GE(seen, count * 8 / 10);
  EXPECT_TRUE(sum / count > 0.08 && sum / count < 0.5) << sum / count;
}

TEST(GeneratedMasks, TheCupIsSmallAndRestsInBetween) {
  const auto sequence = make_generated_sequence("cup", 0, 1);
  int moving = 0, resting = 0;
  for (int i = 0; i < 300; i += 6) {
    const double covered = share(sequence->truth(i).moving);
    EXPECT_LT(covered, 0.08) << i;
    (covered > 0 ? moving : resting)++;
  }
  EXPECT_GT(moving, 20);
  EXPECT_GT(resting, 3);
}

TEST(GeneratedMasks, ApproachGrowsAboutTheImagesMiddle) {
  const auto sequence = make_generated_sequence("approach", 0, 1);
  double least = 1, most = 0;
  for (int i = 0; i < 260; i += 20) {
    const cv::Mat mask = sequence->truth(i).moving;
    EXPECT_NE(mask.at<std::uint8_t>(240, 320), 0) << i;
    least = std::min(least, share(mask)), most = std::max(most, share(mask));
  }
  EXPECT_GT(most, 1.5 * least);
}

// ---- folders
// -------------------------------------------------------------------------------------------------------

TEST(WriteSequence, FolderReadsBackTheSame) {
  const TemporaryFolder folder;
  const auto memory = make_generated_sequence("cup", 3, 4);
  int told = 0;
  write_sequence(*memory, folder.path(),
                 {false, 2, [&](int done, int total) { told = done * (total == 3 ? 1 : 100); }});
  EXPECT_EQ(told, 3);

  const auto read = open_sequence(folder.path());
  ASSERT_EQ(read->size(), 3);
  EXPECT_TRUE(read->has_masks() && read->has_depth());
  EXPECT_EQ(read->camera().fx, memory->camera().fx);
  EXPECT_EQ(read->camera().depth_scale, memory->camera().depth_scale);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(same(memory->read(i), read->read(i))) << i;
    EXPECT_TRUE(same(memory->truth(i).moving, read->truth(i).moving)) << i;
    const Pose off = memory->truth(i).world_from_camera->inverse() * *read->truth(i).world_from_camera;
    EXPECT_LT(off.translation().norm(), 5e-5);  // m; poses come at 100 Hz
  }
}

TEST(WriteSequence, KeepsAFolderThatHoldsASequenceUnlessForced) {
  const TemporaryFolder folder;
  write_sequence(*make_generated_sequence("room", 2, 1), folder.path());
  std::ofstream(fs::path(folder.path("notes.md"))) << "mine";
  const auto shorter = make_generated_sequence("room", 1, 1);
  EXPECT_THAT(sentence_of([&] { write_sequence(*shorter, folder.path()); }), testing::HasSubstr("--force"));
  EXPECT_EQ(open_sequence(folder.path())->size(), 2);
  write_sequence(*shorter, folder.path(), {true, 1, {}});
  EXPECT_EQ(open_sequence(folder.path())->size(), 1);
  EXPECT_TRUE(fs::exists(fs::path(folder.path("notes.md"))));
}

TEST(WriteSequence, SaysWhatCannotBeWritten) {
  const TemporaryFolder folder;
  const auto sequence = make_generated_sequence("room", 1, 1);
  fs::create_directories(fs::path(folder.path()));
  std::ofstream(fs::path(folder.path("file"))) << "not a folder";
  EXPECT_THAT(sentence_of([&] { write_sequence(*sequence, fs::path(folder.path("file"))); }),
              testing::HasSubstr("is a file"));
  EXPECT_THAT(sentence_of([&] { write_sequence(*sequence, fs::path(folder.path("file")) / "inside"); }),
              testing::HasSubstr("cannot be written"));
  const FullDisk full(1000);
  EXPECT_THAT(sentence_of([&] { write_sequence(*sequence, fs::path(folder.path("full"))); }),
              testing::HasSubstr("File too large"));
  EXPECT_FALSE(fs::exists(folder.path("full")));
  EXPECT_FALSE(fs::exists(folder.path("full.part")));
}

TEST(WriteSequence, AnEarlierOneStaysUntilTheNewOneIsWhole) {
  const TemporaryFolder folder;
  const std::string out = folder.path("out");
  write_sequence(*make_generated_sequence("room", 1, 1), out);
  folder.write("out/notes/mine.md", std::string("mine"));
  const auto longer = make_generated_sequence("room", 3, 1);
  WriteOptions options{
      .force = true, .threads = 1, .progress = [&](int, int) { EXPECT_EQ(open_sequence(out)->size(), 1); }};
  write_sequence(*longer, out, options);
  EXPECT_EQ(open_sequence(out)->size(), 3);
  options.progress = [](int done, int) {
    if (done == 2) throw InputError("stopped");
  };
  EXPECT_EQ(sentence_of([&] { write_sequence(*longer, out, options); }), "stopped");
  EXPECT_EQ(open_sequence(out)->size(), 3);
  EXPECT_EQ(folder.read("out/notes/mine.md"), "mine");
  fs::create_directory_symlink("out", folder.path("link"));
  options.progress = {};
  write_sequence(*make_generated_sequence("room", 2, 1), folder.path("link"), options);
  EXPECT_TRUE(fs::is_symlink(folder.path("link")));
  EXPECT_EQ(open_sequence(out)->size(), 2);
  EXPECT_FALSE(fs::exists(folder.path("out.part")));
}

}  // namespace
}  // namespace stillpoint
