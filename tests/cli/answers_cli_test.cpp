// What somebody asks for that cannot be had is answered: options of no use, frames that are not there,
// folders that hold something else, and doubts that name what is wrong rather than what suffers from it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;
using Words = std::vector<std::string>;

CliResult run_none(const std::string& place, const Words& more = {}) {
  Words words = {"run", place, "--method", "none"};
  words.insert(words.end(), more.begin(), more.end());
  return run_cli(words);
}

TEST(Answers, FramesOfMotionAreChosenAsElsewhere) {
  const SmallSequence sequence;
  const auto motion = [&sequence](const std::string& frames) {
    return run_cli({"motion", sequence.path(), "--method", "paper", "--frames", frames, "--force", "--out",
                    sequence.path("motion")});
  };
  expect_one_sentence(motion("90"), "--frames 90: the sequence has frames 0 to 7");
  EXPECT_THAT(motion("-1").out, HasSubstr("6 -> 7: "));
  const CliResult some = motion("2,5:7");
  EXPECT_EQ(some.exit_code, 0) << some.err;
  EXPECT_THAT(some.out, HasSubstr("3 frames, "));
  EXPECT_TRUE(fs::exists(sequence.path("motion/000006")));
}

TEST(Answers, WhatIsNoRunIsNamedAsWhatItIs) {
  const SmallSequence sequence;
  const std::string missing = sequence.path("missing"), none = "is no finished run's folder";
  const std::string page = sequence.path("report.html"), map = sequence.path("map.ply");
  expect_one_sentence(run_cli({"report", missing, "--out", page}), "missing: there is no such folder");
  expect_one_sentence(run_cli({"report", sequence.path(), "--out", page}), none);
  expect_one_sentence(run_cli({"export", sequence.path(), "--to", map}), none);
  expect_one_sentence(run_cli({"export", sequence.path(), "--dense", map}), none);
  const std::string run = sequence.path("run");
  ASSERT_EQ(run_none(sequence.path(), {"--out", run}).exit_code, 0);
  expect_one_sentence(
      run_cli({"snapshot", run, "--baseline", missing, "--panels", "errors", "--out", sequence.path("o")}),
      "missing: there is no such folder");
  fs::remove(run + "/records.bin");
  expect_one_sentence(run_cli({"report", run, "--out", page}), "has no records.bin");
}

TEST(Answers, WhatIsRefusedLeavesNoFolder) {
  const SmallSequence sequence;
  const std::string out = sequence.path("tables/of/mine");
  expect_one_sentence(run_cli({"benchmark", sequence.path(), "--methods", "none", "--run",
                               "theirs=" + sequence.path("nowhere.txt"), "--out", out}),
                      "nowhere.txt: there is no such file or folder");
  EXPECT_FALSE(fs::exists(sequence.path("tables")));
}

TEST(Answers, OptionsOfNoUseAreTold) {
  const SmallSequence sequence;
  sequence.folder.write("groundtruth.txt", "");
  const auto warnings = [&](const Words& more) { return run_none(sequence.path(), more).err; };
  EXPECT_THAT(warnings({"--seed", "3"}), HasSubstr("--seed is of no use here: it goes with generated"));
  EXPECT_THAT(warnings({"--invert-masks"}), HasSubstr("--invert-masks is of no use here"));
  EXPECT_THAT(warnings({"--depth-scale", "5000"}), Not(HasSubstr("of no use here")));
  EXPECT_THAT(
      warnings({"--frame-rate", "15"}),
      HasSubstr("rgb.txt: the stamps are seconds and no frame numbers, so --frame-rate changes nothing"));
  EXPECT_THAT(warnings({"--frame-rate", "30"}), Not(HasSubstr("--frame-rate")));
  expect_usage_error(run_cli({"snapshot", sequence.path(), "--method", "none", "--panels", "input", "--fps",
                              "10", "--out", sequence.path("o")}),
                     "--fps: goes with --video");
  const std::string truth = sequence.path("truth.txt");
  sequence.folder.write("truth.txt", "1 0 0 0 0 0 0 1\n2 1 0 0 0 0 0 1\n3 1 1 0 0 0 0 1\n");
  EXPECT_THAT(run_cli({"evaluate", truth, truth, "--frame-rate", "15"}).err,
              Not(HasSubstr("changes nothing")));
  sequence.folder.write("seconds.txt", "1.5 0 0 0 0 0 0 1\n2.6 1 0 0 0 0 0 1\n3.7 1 1 0 0 0 0 1\n");
  const std::string seconds = sequence.path("seconds.txt");
  EXPECT_THAT(
      run_cli({"evaluate", seconds, seconds, "--frame-rate", "15"}).err,
      HasSubstr("seconds.txt: has no frame numbers to be given times, so --frame-rate changes nothing"));
  const CliResult both = run_cli({"evaluate", truth, truth, "--scale", "--align", "se3"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.err, HasSubstr("excludes"));
  expect_one_sentence(run_cli({"run", "generated:cup:stereo:readout_s=0.02"}),
                      "KIND:stereo, or KIND with times");
}

TEST(Answers, FramesWithoutAPoseAreNamed) {
  const SmallSequence sequence;
  for (int i = 5; i < 8; ++i)
    sequence.folder.write(SmallSequence::colour(i), cv::Mat(SmallSequence::kHeight, SmallSequence::kWidth,
                                                            CV_8UC3, cv::Scalar(9, 9, 9)));
  const CliResult result = run_none(sequence.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("5 of 8 frames tracked"));
  EXPECT_THAT(result.out, HasSubstr("  no pose       3 of 8 frames: 5-7 ("));
}

TEST(Answers, DepthOfTheLargestValueAloneIsNone) {
  const SmallSequence sequence;
  sequence.folder.write(SmallSequence::depth(3),
                        cv::Mat(SmallSequence::kHeight, SmallSequence::kWidth, CV_16UC1, cv::Scalar(65535)));
  const CliResult result = run_none(sequence.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("no depth      1 of 8 frames: 3 ("));
  EXPECT_THAT(result.out, HasSubstr("3.png holds no depth above zero but 65535: none was measured"));
}

constexpr int kCurveFrames = 40;

/// Where a camera is that goes along a curve before the wall, px of its pictures.
cv::Point on_curve(int i) {
  return {SmallSequence::kStep * i, 20 + static_cast<int>(std::lround(18 * std::sin(i / 6.0)))};
}

/// Its path as a trajectory. @param scale times what depth and pictures say
std::string curve(double scale) {
  std::string text;
  for (int i = 0; i < kCurveFrames; ++i) {
    const cv::Point2d at = cv::Point2d(on_curve(i)) * (scale * SmallSequence::kDepth / SmallSequence::kFocal);
    text += fmt::format("{:.4f} {:.6f} {:.6f} 0 0 0 0 1\n", SmallSequence::stamp(i), at.x, at.y);
  }
  return text;
}

/// A sequence along that curve, whose truth is half as long as its depth says.
void take_the_curve(const SmallSequence& sequence) {
  const cv::Size picture(SmallSequence::kWidth, SmallSequence::kHeight);
  cv::Mat wall(picture.height + 40, picture.width + SmallSequence::kStep * kCurveFrames, CV_8UC3,
               cv::Scalar());
  cv::RNG random(5);
  for (int i = 0; i < 1500; ++i)
    cv::rectangle(wall,
                  cv::Rect(random.uniform(-10, wall.cols), random.uniform(-10, wall.rows),
                           random.uniform(5, 30), random.uniform(5, 30)),
                  cv::Scalar::all(random.uniform(0, 256)), cv::FILLED);
  for (int i = 0; i < kCurveFrames; ++i)
    sequence.folder.write(SmallSequence::colour(i), wall(cv::Rect(on_curve(i), picture)).clone());
  sequence.folder.write("groundtruth.txt", curve(0.5));
}

TEST(Answers, TheScaleIsNotBlamedForTheClockOfDepth) {
  const SmallSequence sequence(kCurveFrames);
  take_the_curve(sequence);
  const std::string scale = "is the depth scale right?",
                    clock = "the clock of depth, which seems 0.500 s late";
  EXPECT_THAT(run_none(sequence.path()).out, HasSubstr(scale));
  // 15 frames later: 25 of 40 meet a colour image, of another time.
  std::string depths;
  for (int i = 0; i < kCurveFrames; ++i)
    depths += fmt::format("{:.4f} {}\n", SmallSequence::stamp(i + 15), SmallSequence::depth(i));
  sequence.folder.write("depth.txt", depths);
  const CliResult late = run_none(sequence.path());
  EXPECT_THAT(late.out, Not(HasSubstr(scale)));
  EXPECT_THAT(late.out, HasSubstr(clock));
  EXPECT_THAT(late.err, HasSubstr("the first depth image is 0.500 s later"));
  const CliResult check = run_cli({"check", sequence.path()});
  EXPECT_THAT(check.out, HasSubstr("the first depth image is 0.500 s later"));
  EXPECT_THAT(check.out, Not(HasSubstr("`--depth-scale` sets the depth's")));
  // Who says how late it is settles the clock, and the scale is asked for again.
  EXPECT_THAT(run_none(sequence.path(), {"--depth-offset", "-0.5"}).out, HasSubstr(scale));
}

TEST(Answers, ADoubtAboutAnotherProgramsRunIsAboutThatRun) {
  const SmallSequence sequence(kCurveFrames);
  sequence.folder.write("groundtruth.txt", curve(1.0));
  sequence.folder.write("small.txt", curve(0.25));
  const CliResult imported = run_cli(
      {"import", sequence.path(), "mono=" + sequence.path("small.txt"), "--out", sequence.path("mono")});
  EXPECT_EQ(imported.exit_code, 0) << imported.err;
  EXPECT_THAT(imported.out, HasSubstr("multiplied by 4.000 (`stillpoint evaluate --align sim3` does so)"));
  EXPECT_THAT(imported.out, Not(HasSubstr("depth scale")));

  // It left no features, and figures say so in place of empty pictures.
  const CliResult figures = run_cli({"figures", sequence.path("mono"), "--frame", "20", "--scale", "0.5",
                                     "--out", sequence.path("figures")});
  EXPECT_EQ(figures.exit_code, 0) << figures.err;
  EXPECT_THAT(figures.out, HasSubstr("figures 3 and 4 are left out: mono left no features of frame 20"));
  EXPECT_THAT(figures.out, HasSubstr("error over time of another program's run mono"));
  EXPECT_THAT(figures.out, Not(HasSubstr("method none removes")));
  EXPECT_FALSE(fs::exists(sequence.path("figures/figure3.png")));
}

TEST(Answers, DoubtsStandUnderTablesToo) {
  const SmallSequence sequence(kCurveFrames);
  take_the_curve(sequence);
  sequence.folder.write("small.txt", curve(0.05));
  const std::string name = fs::path(sequence.path()).filename().string();
  const CliResult benchmark = run_cli({"benchmark", sequence.path(), "--methods", "none", "--run",
                                       "mono=" + sequence.path("small.txt"), "--out", sequence.path("out")});
  EXPECT_EQ(benchmark.exit_code, 0) << benchmark.err;
  EXPECT_THAT(benchmark.out, HasSubstr("\n- " + name + ", mono: the estimate fits "));
  EXPECT_THAT(benchmark.out, HasSubstr("\n- " + name + ", none, odometry features: the estimate fits "));
  const auto json = [&sequence](const char* file) {
    return nlohmann::json::parse(sequence.folder.read(file));
  };
  const auto results = json("out/results.json");
  for (const auto& run : results.at("runs"))
    EXPECT_THAT(run.at("doubt").get<std::string>(), HasSubstr("its lengths are multiplied by"));
  const CliResult sweep = run_cli({"sweep", sequence.path(), "--method", "none", "--parameter",
                                   "features.count=400:500:2", "--out", sequence.path("swept")});
  EXPECT_THAT(sweep.out, HasSubstr("\n- features.count = 400: the estimate fits "));
  EXPECT_THAT(json("swept/sweep.json")[0].at("points")[1].at("doubt").get<std::string>(),
              HasSubstr("is the depth scale right?"));
  const CliResult ablate = run_cli(
      {"ablate", sequence.path(), "--method", "none", "--without", "huber", "--out", sequence.path("a")});
  EXPECT_THAT(ablate.out, HasSubstr("\n- " + name + ", without huber: the estimate fits "));
  EXPECT_THAT(sequence.folder.read("a/ablation.md"), HasSubstr(", whole method: the estimate fits "));
}

TEST(Answers, AnEstimateMayBeARunsFolder) {
  const SmallSequence sequence(12);
  const std::string run = sequence.path("run");
  ASSERT_EQ(run_none(sequence.path(), {"--out", run}).exit_code, 0);
  const auto table = [](const CliResult& result) {
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.out.substr(result.out.find("Matched"));
  };
  EXPECT_EQ(table(run_cli({"evaluate", sequence.path(), run})),
            table(run_cli({"evaluate", sequence.path(), run + "/trajectory.txt"})));
  const CliResult check = run_cli({"check", sequence.path(), run});
  EXPECT_NE(check.exit_code, 1) << check.err;
  EXPECT_THAT(check.out, HasSubstr("figures   12 of 12 poses beside the ground truth: ATE 0."));
  expect_one_sentence(run_cli({"evaluate", sequence.path("groundtruth.txt"), sequence.path("rgb")}),
                      "rgb: holds no trajectory");
}

TEST(Answers, AChoiceThatIsNoneIsNamed) {
  const SmallSequence sequence;
  expect_one_sentence(run_cli({"benchmark", sequence.path(), "--methods", "none,nosuch"}),
                      "and not 'nosuch'");
}

}  // namespace
}  // namespace stillpoint
