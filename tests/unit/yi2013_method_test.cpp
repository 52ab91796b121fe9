// Method `yi2013` as a whole: what it finds, leaves alone, keeps and says. Its arithmetic is in
// yi2013_test.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/config.hpp"
#include "core/motion/methods.hpp"
#include "core/motion/motion_method.hpp"
#include "core/motion/stage_log.hpp"
#include "core/motion/yi2013/yi2013_config.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "core/sequence/generated/generated_sequence.hpp"
#include "tests/support/rendered.hpp"
#include "tests/unit/motion_scene.hpp"

namespace stillpoint {
namespace {

bool same_pixels(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

std::unique_ptr<MotionMethod> method() { return method_named("yi2013").make(Camera(), Config()); }

MotionResult next(MotionMethod& method, const cv::Mat& gray, int index, int threads = 1) {
  Frame frame;
  frame.index = index;
  frame.gray = gray;
  MotionInput input{frame};
  input.threads = threads;
  MotionResult result = method.detect(input);
  method.commit(input, result, {});
  return result;
}

StageLog described(const MotionMethod& method, const cv::Mat& gray, int index, const MotionResult& result) {
  Frame frame;
  frame.index = index;
  frame.gray = gray;
  return method.describe(frame, result);
}

TEST(Yi2013Method, StaticNoiseIsNotDynamic) {
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG(11).fill(noise, cv::RNG::UNIFORM, 64, 192);
  const auto yi = method();
  MotionResult result;
  for (int i = 0; i < 6; ++i) {
    result = next(*yi, noise, i);
    EXPECT_EQ(cv::countNonZero(result.mask), 0) << "frame " << i;
  }
  // All but the outermost ring of blocks is judged.
  const StageLog log = described(*yi, noise, 5, result);
  EXPECT_NEAR(percent_known(log.layer("deviation")->image), 100.0 * 158 * 118 / (160 * 120), 0.01);
}

/// A camera that goes over a plane by the same homography each frame, and a patch that goes its own way once
/// it is there.
struct Scene {
  int enters = 8;  ///< frame in which the patch appears
  cv::Matx33d last_from_here = motion_test::slight_motion();
  cv::Mat ground = motion_test::textured_image({1100, 900}, 5),
          patch = motion_test::textured_image({120, 120}, 9);

  Scene() {
    cv::add(ground * 0.6, 0, ground);
    cv::add(patch * 0.6, 100, patch);
  }
  [[nodiscard]] static cv::Rect patch_at(int frame) { return {200 + 9 * frame, 150 + 5 * frame, 120, 120}; }
  [[nodiscard]] cv::Mat frame(int index) const {
    cv::Matx33d ground_from_here(1, 0, 200, 0, 1, 200, 0, 0, 1);
    for (int i = 0; i < index; ++i) ground_from_here = ground_from_here * last_from_here;
    cv::Mat image;
    cv::warpPerspective(ground, image, ground_from_here, {640, 480}, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                        cv::BORDER_REFLECT);
    if (index >= enters) patch.copyTo(image(patch_at(index)));
    return image;
  }
};

constexpr int kFrames = 14;

TEST(Yi2013Method, FindsAMovingPatchBeforeAMovingBackground) {
  const Scene scene;
  const auto yi = method();
  MotionResult result;
  for (int i = 0; i < kFrames; ++i) result = next(*yi, scene.frame(i), i);
  cv::Mat truth = cv::Mat::zeros(480, 640, CV_8UC1), at_patch = truth.clone();
  truth(Scene::patch_at(kFrames - 1)).setTo(255);
  cv::bitwise_and(result.mask, truth, at_patch);
  const double found = percent_set(at_patch) / percent_set(truth);
  const double right = percent_set(at_patch) / percent_set(result.mask);
  RecordProperty("found", std::to_string(found));
  RecordProperty("right", std::to_string(right));
  EXPECT_GT(found, 0.9);
  EXPECT_GT(right, 0.9);
  EXPECT_NEAR(result.mask_share, percent_set(result.mask) / 100.0, 1e-12);

  const StageLog log = described(*yi, scene.frame(kFrames - 1), kFrames - 1, result);
  EXPECT_EQ(log.reference, kFrames - 2);
  ASSERT_TRUE(log.backward && log.forward);
  for (const cv::Point2d& corner : {cv::Point2d(0, 0), cv::Point2d(639, 0), cv::Point2d(320, 479)}) {
    const cv::Vec3d p(corner.x, corner.y, 1.0);
    const cv::Vec3d measured = *log.backward * p, known = scene.last_from_here * p;
    EXPECT_NEAR(measured[0] / measured[2], known[0] / known[2], 0.3);
    EXPECT_NEAR(measured[1] / measured[2], known[1] / known[2], 0.3);
    const cv::Vec3d again = *log.forward * measured;
    EXPECT_NEAR(again[0] / again[2], corner.x, 1e-6);
  }
  const cv::Point2f middle(cv::Point(Scene::patch_at(kFrames - 1).tl()) + cv::Point(60, 60));
  const auto sentences = log.explain(middle, true);
  ASSERT_EQ(sentences.size(), 2U);
  EXPECT_EQ(log.layer("mask")->image.at<std::uint8_t>(cv::Point(middle)) != 0,
            sentences[0].find("beyond the limit of 2.0 σ") != std::string::npos);
}

TEST(Yi2013Method, StaysQuietWhereNothingMovesButTheCamera) {
  Scene scene;
  scene.enters = kFrames;
  const auto yi = method();
  for (int i = 0; i < kFrames; ++i) {
    const MotionResult result = next(*yi, scene.frame(i), i);
    EXPECT_LT(result.mask_share, 0.01) << "frame " << i;
  }
}

TEST(Yi2013Method, ClonesAndThreadsAndLookingTwiceChangeNothing) {
  Scene scene;
  scene.enters = 4;
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  const auto one = method();
  for (int i = 0; i < 5; ++i) (void)next(*one, scene.frame(i), i);
  const auto copy = one->clone();
  (void)next(*copy, scene.frame(9), 9);  // of no consequence to the original
  const auto other = one->clone();
  for (int i = 5; i < 8; ++i) {
    const cv::Mat gray = scene.frame(i);
    cv::setNumThreads(4);
    Frame frame;
    frame.gray = gray;
    (void)other->detect({frame});  // judged, and not committed
    const MotionResult there = next(*other, gray, i, 4);
    cv::setNumThreads(1);
    const MotionResult here = next(*one, gray, i, 1);
    EXPECT_GT(cv::countNonZero(here.mask), 0);
    EXPECT_TRUE(same_pixels(here.mask, there.mask)) << i;
    EXPECT_EQ(here.figures, there.figures);
    const StageLog a = described(*one, gray, i, here), b = described(*other, gray, i, there);
    for (const char* id : {"mean_0", "mean_1", "sigma_0", "sigma_1", "age_0", "age_1", "matches"}) {
      ASSERT_NE(a.layer(id), nullptr) << id;
      EXPECT_TRUE(same_pixels(a.layer(id)->image, b.layer(id)->image)) << id << ", frame " << i;
    }
    EXPECT_FALSE(same_pixels(described(*copy, gray, i, copy->detect({frame})).layer("age_0")->image,
                             a.layer("age_0")->image));
  }
  cv::setNumThreads(threads);
}

TEST(Yi2013Method, FramesOfAnotherSizeBeginTheModelAnew) {
  const Scene scene;
  const auto seasoned = method(), fresh = method();
  for (int i = 0; i < 4; ++i) (void)next(*seasoned, scene.frame(i), i);
  // As many blocks as before, so that only the frames' size tells.
  for (int i = 4; i < 8; ++i) {
    const cv::Mat wider = [&] {
      cv::Mat image;
      cv::resize(scene.frame(i), image, {642, 480});
      return image;
    }();
    const MotionResult a = next(*seasoned, wider, i), b = next(*fresh, wider, i);
    EXPECT_TRUE(same_pixels(a.mask, b.mask));
    EXPECT_EQ(a.note.empty(), i > 4) << a.note;
    EXPECT_EQ(a.figures.empty(), i == 4);
  }
}

TEST(Yi2013Method, SaysWhenThereIsNothingToFollow) {
  const cv::Mat flat(480, 640, CV_8UC1, cv::Scalar(90));
  const auto yi = method();
  (void)next(*yi, flat, 0);
  const MotionResult result = next(*yi, flat, 1);
  EXPECT_EQ(result.note, "only 0 points could be followed: the camera is taken to be static");
  const StageLog log = described(*yi, flat, 1, result);
  EXPECT_EQ(cv::norm(*log.backward - cv::Matx33d::eye()), 0.0);
  EXPECT_EQ(next(*method(), cv::Mat(3, 3, CV_8UC1, cv::Scalar(0)), 0).note,
            "the image is smaller than a block of the background model");
}

TEST(Yi2013Method, ThePresetHoldsThePublishedConstants) {
  const Config config = load_config("yi2013");
  EXPECT_EQ(config.run.method, "yi2013");
  EXPECT_EQ(config.of<Yi2013Config>(), Yi2013Config());
}

TEST(Yi2013Method, NoOtherFigureBearsItsFiguresNames) {
  // A figure whose name is taken is left out of the list.
  for (const FigureInfo& mine : method_named("yi2013").figures) {
    int listed = 0;
    for (const FigureInfo& info : frame_figure_infos()) listed += info.help == mine.help ? 1 : 0;
    EXPECT_EQ(listed, 1) << mine.name;
  }
}

TEST(Yi2013Method, ARunGivesTheSameBytesWhateverTheThreads) {
  const auto source = rendered("walking_xyz", 6);
  Config config;
  config.run.method = "yi2013";
  config.run.threads = 1;
  const RunResult one = run_sequence(*source, config);
  config.run.threads = 4;
  EXPECT_EQ(run_hash(one.records), run_hash(run_sequence(*source, config).records));
  EXPECT_GT(one.records.back().mask_share, 0.0);
  ASSERT_EQ(one.records.back().motion_figures.size(), 3U);
  EXPECT_EQ(one.records.back().motion_figures[0].name, "yi2013_tracks");
}

TEST(Yi2013Method, TheFrameAfterTheFirstJudgesNoPixel) {
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG random(5);
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, noise, {0, 0}, 1.5);
  cv::normalize(noise, noise, 60, 140, cv::NORM_MINMAX);
  for (int turn = 1; turn < 6; ++turn) {
    auto method = method_named("yi2013").make(Camera{}, Config{});
    for (int i = 0; i < 2; ++i) {
      Frame frame;
      frame.index = i;
      // A turn about the corner shares blocks in every way there is.
      const double angle = 0.004 * turn * i;
      cv::warpAffine(
          noise, frame.gray,
          cv::Matx23d(std::cos(angle), -std::sin(angle), 1.3 * i, std::sin(angle), std::cos(angle), 0.9 * i),
          noise.size(), cv::INTER_LINEAR, cv::BORDER_REFLECT);
      // Something bright has come, on a fifth of the view.
      if (i == 1) frame.gray(cv::Rect(100, 100, 300, 200)) += 110;
      const MotionInput input{frame, nullptr};
      const MotionResult result = method->detect(input);
      EXPECT_EQ(result.mask_share, 0.0) << i << ", " << turn;
      method->commit(input, result, {});
    }
  }
}

/// Four unlike blocks in the middle of six by six.

}  // namespace
}  // namespace stillpoint
