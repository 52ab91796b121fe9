// Images without a display, and a window without one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <thread>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/xvfb.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Snapshot : public ::testing::Test {
 protected:
  [[nodiscard]] CliResult snapshot(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"snapshot", sequence_.path()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_cli(arguments);
  }
  [[nodiscard]] std::string out() const { return sequence_.path("out"); }

  SmallSequence sequence_{6};
};

TEST_F(Snapshot, WritesPanelsAndTheWorkbench) {
  const CliResult result =
      snapshot({"--frames", "2,4", "--panels", "workbench,union_mask", "--size", "800x600", "--out", out()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("4 images of 2 frames"));
  for (const char* name :
       {"000002_workbench", "000002_union_mask", "000004_workbench", "000004_union_mask"}) {
    const cv::Mat image = cv::imread(out() + "/" + name + ".png");
    EXPECT_EQ(image.size(), cv::Size(800, 600)) << name;
    cv::Scalar mean, deviation;
    cv::meanStdDev(image, mean, deviation);
    EXPECT_GT(deviation[0], 5.0) << name;
  }
}

TEST_F(Snapshot, WritesItsPlotsAndTablesAsFiles) {
  const CliResult result = snapshot(
      {"--frames", "4", "--panels", "timeline,trajectory,mask", "--plots", "svg,csv", "--out", out()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto read = [&](const char* name) {
    return sequence_.folder.read(std::string("out/000004_") + name);
  };
  for (const char* plot : {"timeline_inliers", "timeline_rpe", "trajectory"}) {
    EXPECT_THAT(read((std::string(plot) + ".svg").c_str()), HasSubstr("</svg>")) << plot;
    EXPECT_THAT(read((std::string(plot) + ".csv").c_str()), HasSubstr(",")) << plot;
  }
  std::istringstream poses(read("trajectory_poses.csv"));
  int baseline = 0;
  for (std::string line; std::getline(poses, line);)
    baseline += line.rfind("none (baseline),", 0) == 0 ? 1 : 0;
  EXPECT_EQ(baseline, 5) << "a row for each frame up to this one";
  EXPECT_FALSE(fs::exists(out() + "/000004_trajectory_poses.svg")) << "a table is no plot";
  int plots = 0;
  for (const auto& entry : fs::directory_iterator(out()))
    plots += entry.path().extension() == ".svg" || entry.path().extension() == ".csv" ? 1 : 0;
  EXPECT_THAT(result.out,
              HasSubstr("3 images, and " + std::to_string(plots) + " files of plots and tables, of "));
}

TEST_F(Snapshot, SaysWherePlotsCannotBeWritten) {
  expect_usage_error(snapshot({"--panels", "mask", "--plots", "png", "--out", out()}), "--plots");
  expect_usage_error(snapshot({"--panels", "timeline", "--plots", "svg", "--video", sequence_.path("v.mp4")}),
                     "--plots");
}

TEST_F(Snapshot, GivesTheSameBytesEachTime) {
  for (const char* folder : {"a", "b"})
    EXPECT_EQ(snapshot({"--frames", "4", "--panels", "all,workbench", "--plots", "svg,pdf,csv", "--out",
                        sequence_.path(folder)})
                  .exit_code,
              0);
  int compared = 0;
  for (const auto& entry : fs::directory_iterator(sequence_.path("a"))) {
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(sequence_.folder.read("a/" + name), sequence_.folder.read("b/" + name)) << name;
    ++compared;
  }
  EXPECT_GT(compared, 5);
}

TEST_F(Snapshot, SaysWhatIsWrongInOneSentence) {
  expect_one_sentence(snapshot({"--frames", "6", "--out", out()}), "frames 0 to 5");
  expect_one_sentence(snapshot({"--frames", "4", "--length", "3", "--out", out()}), "frames 0 to 2");
  expect_one_sentence(snapshot({"--frames", "two", "--out", out()}), "expected frames like");
  expect_one_sentence(snapshot({"--panels", "unionmask", "--out", out()}),
                      "there is no such panel; there are all, workbench");
  expect_one_sentence(snapshot({"--panels", ",", "--out", out()}), "names no panel");
  expect_one_sentence(snapshot({"--size", "9x9", "--out", out()}), "--size");
  expect_one_sentence(snapshot({"--theme", "pink", "--out", out()}), "no theme 'pink'");
  expect_one_sentence(snapshot({"--layout", sequence_.path("none.json"), "--out", out()}), "cannot be read");
  sequence_.folder.write("layout.json", std::string("{\"panel\": \"nothing\"}"));
  expect_one_sentence(snapshot({"--layout", sequence_.path("layout.json"), "--out", out()}),
                      "no panel 'nothing'");
  sequence_.folder.write("file", std::string("x"));
  expect_one_sentence(snapshot({"--out", sequence_.path("file")}), "file");
  expect_one_sentence(run_cli({"snapshot", sequence_.path("nowhere"), "--out", out()}), "nowhere");
}

TEST_F(Snapshot, SaysWhatItCannotDrawBeforeTheSequenceIsOpened) {
  // Of a sequence that is not there nothing is said: it has not been looked for.
  const auto from_nowhere = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"snapshot", sequence_.path("nowhere")});
    return run_cli(more);
  };
  expect_one_sentence(from_nowhere({"--panels", "input,unionmask", "--out", out()}),
                      "there is no such panel");
  expect_one_sentence(from_nowhere({"--panels", ",", "--out", out()}), "names no panel");
  expect_one_sentence(from_nowhere({"--size", "9x9", "--out", out()}), "--size");
  expect_one_sentence(from_nowhere({"--layout", sequence_.path("none.json"), "--out", out()}),
                      "cannot be read");
  expect_usage_error(from_nowhere({"--panels", "input"}), "--out or --video is required");
  expect_one_sentence(from_nowhere({"--panels", "input,motion", "--video", sequence_.path("v.mp4")}),
                      "--panels names 2");
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(Snapshot, APictureThatCannotBeWrittenIsToldWhicheverItIs) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full to stand for a full disk";
  // They are packed beside drawing: the first fails while others are drawn, the last when all are.
  const std::vector<std::string> pictures = {"000002_input", "000004_trajectory"};
  for (const std::string& full : pictures) {
    const std::string folder = sequence_.path("out_of_" + full);
    fs::create_directories(folder);
    fs::create_symlink("/dev/full", folder + "/" + full + ".png");
    const CliResult result = snapshot(
        {"--frames", "2,4", "--panels", "input,errors,timeline,trajectory", "--out", folder, "--force"});
    // A slow machine was shown how far it is before.
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.out, "");
    EXPECT_THAT(result.err, HasSubstr("stillpoint: " + folder + "/" + full + ".png: cannot be written"));
    EXPECT_FALSE(fs::exists(folder + "/snapshots.txt")) << "taken for whole";
  }
}

TEST_F(Snapshot, SetsRunsAgainstEachOther) {
  const auto picture = [&](const std::string& folder, std::vector<std::string> more) {
    std::vector<std::string> all = {"--method", "paper", "--frames", "4",
                                    "--panels", "mask",  "--out",    sequence_.path(folder)};
    all.insert(all.end(), more.begin(), more.end());
    const CliResult result = snapshot(all);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return cv::imread(sequence_.path(folder) + "/000004_mask.png");
  };
  const cv::Mat alone = picture("alone", {}),
                wiped = picture("wiped", {"--compare", "none", "--wipe", "all"}),
                flipped = picture("flipped", {"--compare", "none", "--flip", "none"});
  ASSERT_EQ(alone.size(), wiped.size());
  EXPECT_GT(cv::norm(alone, wiped, cv::NORM_INF), 50.0);
  EXPECT_GT(cv::norm(alone, flipped, cv::NORM_INF), 50.0);
  EXPECT_GT(cv::norm(wiped, flipped, cv::NORM_INF), 50.0);
  expect_one_sentence(snapshot({"--wipe", "all", "--no-baseline", "--frames", "4", "--out", out()}),
                      "--wipe takes two runs with pictures at least, and of stillpoint only stillpoint");
  // The baseline is a run like the others, and removes nothing.
  const cv::Mat plain = picture("plain", {"--flip", "none (baseline)"});
  EXPECT_GT(cv::norm(alone, plain, cv::NORM_INF), 50.0);
  EXPECT_GT(cv::norm(picture("both", {"--wipe", "all"}), alone, cv::NORM_INF), 50.0);
  expect_one_sentence(snapshot({"--compare", "none", "--wipe", "stillpoint,orb3", "--out", out()}),
                      "there is no run orb3; there are stillpoint, none (baseline), none");
  expect_one_sentence(snapshot({"--compare", "nothing", "--out", out()}), "nothing");
  const std::string earlier = sequence_.path("earlier");
  ASSERT_EQ(run_cli({"run", sequence_.path(), "--method", "none", "--out", earlier}).exit_code, 0);
  EXPECT_GT(
      cv::norm(picture("by_name", {"--run", "mine=" + earlier, "--wipe", "paper,mine"}), alone, cv::NORM_INF),
      50.0);
  // Without masks these would remove nothing, under their own names.
  expect_one_sentence(snapshot({"--compare", "masks", "--out", out()}), "--masks DIR|LIST");
  expect_one_sentence(snapshot({"--method", "masks", "--out", out()}), "--masks DIR|LIST");
}

TEST_F(Snapshot, NamesOfRunsMayHoldCommas) {
  const std::string earlier = sequence_.path("earlier");
  ASSERT_EQ(run_cli({"run", sequence_.path(), "--method", "none", "--out", earlier}).exit_code, 0);
  const std::vector<std::string> common = {"--frames", "4",     "--panels",
                                           "mask",     "--run", "left,right=" + earlier};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), common.begin(), common.end());
    more.insert(more.end(), {"--out", out(), "--force"});
    return snapshot(more);
  };
  EXPECT_EQ(with({"--wipe", R"(stillpoint,left\,right)"}).exit_code, 0);
  EXPECT_EQ(with({"--wipe", "stillpoint", "--wipe", R"(left\,right)"}).exit_code, 0);
  EXPECT_EQ(with({"--flip", "left,right"}).exit_code, 0);
  fs::remove_all(out());
  expect_one_sentence(with({"--wipe", "stillpoint,left,right"}), "there is no run left; there are");
  // A list of nothing is not one of all.
  expect_usage_error(with({"--wipe", ""}), "--wipe: its value is empty");
  for (const char* list : {",", " "})
    expect_one_sentence(with({"--wipe", list}), fmt::format("--wipe '{}': names nothing", list));
  expect_one_sentence(with({"--compare", ","}), "--compare ',': names nothing");
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(Snapshot, ARunWithoutPicturesIsRefused) {
  std::string path;
  for (int i = 0; i < 6; ++i)
    path += fmt::format("{:.4f} {} 0 0 0 0 0 1\n", SmallSequence::stamp(i), 0.01 * i);
  sequence_.folder.write("path.txt", path);
  const std::vector<std::string> common = {
      "--frames", "2:4",           "--panels", "mask",
      "--out",    out() + "/deep", "--run",    "orb3=" + sequence_.path("path.txt")};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.end(), common.begin(), common.end());
    return snapshot(more);
  };
  expect_one_sentence(with({"--flip", "orb3"}),
                      "--flip orb3: orb3 is another program's trajectory: it has no pictures");
  // What was refused leaves no folder.
  EXPECT_FALSE(fs::exists(out()));
  expect_one_sentence(with({"--wipe", "all", "--no-baseline"}),
                      "of stillpoint, orb3 only stillpoint has any");
  EXPECT_FALSE(fs::exists(out()));
  EXPECT_EQ(with({"--wipe", "stillpoint,orb3"}).exit_code, 0);
}

TEST_F(Snapshot, FramesWithoutPicturesOfARunAreLeftOutAndTold) {
  // Masks of some frames alone.
  std::string path;
  for (int i = 0; i < 6; ++i)
    path += fmt::format("{:.4f} {} 0 0 0 0 0 1\n", SmallSequence::stamp(i), 0.01 * i);
  sequence_.folder.write("theirs/trajectory.txt", path);
  cv::Mat mask(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1, cv::Scalar(0));
  mask(cv::Rect(40, 60, 80, 80)).setTo(255);
  for (const int i : {2, 3}) sequence_.folder.write(fmt::format("theirs/masks/{}.png", i), mask);
  const auto flipped = [&](const std::string& frames) {
    return snapshot({"--frames", frames, "--panels", "mask", "--out", out(), "--force", "--flip", "theirs",
                     "--run", "theirs=" + sequence_.path("theirs")});
  };
  const CliResult some = flipped("1:5");
  EXPECT_EQ(some.exit_code, 0) << some.err;
  EXPECT_THAT(some.err, HasSubstr("2 of 4 frames are left out: --flip theirs: theirs left neither mask nor"));
  EXPECT_THAT(some.out, HasSubstr("2 images of 2 frames"));
  fs::remove_all(out());
  const CliResult none = flipped("4");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("theirs left neither mask nor features of frame 4."));
  EXPECT_FALSE(fs::exists(out()));
}

TEST_F(Snapshot, KeepsEarlierImagesUnlessForced) {
  const std::vector<std::string> wanted = {"--frames", "0", "--panels", "input", "--out", out()};
  EXPECT_EQ(snapshot(wanted).exit_code, 0);
  expect_one_sentence(snapshot(wanted), "--force");
  EXPECT_EQ(snapshot({"--frames", "0", "--panels", "input", "--out", out(), "--force"}).exit_code, 0);
}

TEST_F(Snapshot, ColourAloneIsEnough) {
  fs::remove(sequence_.path("depth.txt"));
  fs::remove(sequence_.path("groundtruth.txt"));
  const CliResult result = snapshot({"--frames", "3", "--panels", "all", "--out", out()});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(cv::imread(out() + "/000003_union_mask.png").empty());
}

TEST(View, WithoutADisplayNamesSnapshot) {
  ::unsetenv("DISPLAY");
  ::unsetenv("WAYLAND_DISPLAY");
  const SmallSequence sequence(2);
  expect_one_sentence(run_cli({"view", sequence.path()}), "stillpoint snapshot");
  expect_one_sentence(run_cli({"view"}), "stillpoint snapshot");
  expect_one_sentence(run_cli({}), "stillpoint snapshot");
}

TEST(View, ComesBackAsItWasLeft) {
  const stillpoint::testing::Xvfb xvfb;
  if (!xvfb.running()) GTEST_SKIP() << "Xvfb is not installed";
  const SmallSequence sequence(4);
  ::setenv("XDG_CONFIG_HOME", sequence.path("config").c_str(), 1);
  std::string left;
  for (const std::vector<std::string>& arguments :
       std::vector<std::vector<std::string>>{{"view", sequence.path()}, {"view"}}) {
    CliProcess window(arguments);
    std::this_thread::sleep_for(std::chrono::seconds(3));
    window.send(SIGTERM);
    const CliResult result = window.wait();
    EXPECT_EQ(result.exit_code, 128 + SIGTERM) << result.err;
    EXPECT_FALSE(result.by_signal);
    const std::string now = sequence.folder.read("config/stillpoint/settings.json");
    EXPECT_THAT(now, HasSubstr(sequence.path()));
    EXPECT_THAT(now, HasSubstr("\"motion\""));
    if (!left.empty()) {
      EXPECT_EQ(now, left);
    }
    left = now;
  }
  EXPECT_FALSE(left.empty());
  ::unsetenv("XDG_CONFIG_HOME");
}

TEST(View, SaysWhatItCannotOpen) {
  expect_one_sentence(run_cli({"view", "/nowhere/at/all"}), "/nowhere/at/all");
}

}  // namespace
}  // namespace stillpoint
