// Finished runs as a user looks at them: images, videos, figures and reports of a run's folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <thread>

#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/xvfb.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class RunFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* method : {"none", "stillpoint"}) {
      const CliResult ran = run_cli({"run", sequence_.path(), "--method", method, "--out", run(method)});
      ASSERT_EQ(ran.exit_code, 0) << ran.err;
    }
  }

  [[nodiscard]] std::string run(const std::string& method) const { return out_.path("runs/" + method); }
  [[nodiscard]] std::string page() const { return out_.path("report.html"); }
  [[nodiscard]] CliResult snapshot(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"snapshot", run("stillpoint"), "--out", out_.path("images")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_cli(arguments);
  }

  SmallSequence sequence_{8};
  TemporaryFolder out_{"out <b>&\"c\""};  // what a page must not take for its own
};

TEST_F(RunFolder, ShowsWhatALiveSessionShows) {
  const std::vector<std::string> panels = {"--frames", "6", "--panels",
                                           "trajectory,errors,features_before,features_after,motion"};
  ASSERT_EQ(snapshot(panels).exit_code, 0);
  std::vector<std::string> live = {"snapshot",   sequence_.path(), "--method",
                                   "stillpoint", "--out",          out_.path("live")};
  live.insert(live.end(), panels.begin(), panels.end());
  ASSERT_EQ(run_cli(live).exit_code, 0);
  // What depends on the frame alone, not on how far the run has come, is the same to the last pixel.
  for (const char* name : {"features_before", "features_after", "motion"}) {
    const std::string file = std::string("/000006_") + name + ".png";
    const cv::Mat opened = cv::imread(out_.path("images") + file), ran = cv::imread(out_.path("live") + file);
    ASSERT_FALSE(opened.empty()) << name;
    EXPECT_EQ(cv::norm(opened, ran, cv::NORM_INF), 0.0) << name;
  }
  EXPECT_EQ(cv::imread(out_.path("images") + "/000006_errors.png").size(), cv::Size(960, 780));
}

TEST_F(RunFolder, SaysItsSequenceInTheSummary) {
  const auto summary = nlohmann::json::parse(out_.read("runs/none/summary.json"));
  EXPECT_EQ(summary.at("source").at("where"), sequence_.path());
  EXPECT_EQ(summary.at("source").at("frames"), 8);
  EXPECT_EQ(summary.at("source").at("fingerprint").get<std::string>().size(), 16U);
}

TEST_F(RunFolder, WithoutItsSequenceShowsItsRecords) {
  fs::rename(sequence_.path(), sequence_.path() + "_elsewhere");
  const CliResult shown = snapshot({"--frames", "6", "--panels", "all,workbench"});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.err, HasSubstr("stillpoint: warning: " + sequence_.path()));
  EXPECT_FALSE(cv::imread(out_.path("images/000006_features_after.png")).empty());
  const CliResult told =
      snapshot({"--frames", "6", "--force", "--sequence", sequence_.path() + "_elsewhere"});
  EXPECT_EQ(told.exit_code, 0);
  EXPECT_EQ(told.err.find("warning"), std::string::npos) << told.err;
  expect_one_sentence(run_cli({"figures", run("none"), "--frame", "3", "--out", out_.path("figures")}),
                      sequence_.path());
  const CliResult reported = run_cli({"report", run("none"), run("stillpoint"), "--out", page()});
  EXPECT_EQ(reported.exit_code, 0) << reported.err;
  EXPECT_THAT(out_.read("report.html"), HasSubstr("Without images: "));
  fs::rename(sequence_.path() + "_elsewhere", sequence_.path());
}

TEST_F(RunFolder, OfTheFirstFramesFindsThemAgain) {
  ASSERT_EQ(run_cli({"run", sequence_.path(), "--frames", "5", "--method", "none", "--out", run("short")})
                .exit_code,
            0);
  const auto summary = nlohmann::json::parse(out_.read("runs/short/summary.json"));
  EXPECT_EQ(summary.at("source").at("frames"), 5);
  const CliResult shown = run_cli(
      {"snapshot", run("short"), "--frames", "-1", "--panels", "input", "--out", out_.path("images")});
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_EQ(shown.err.find("warning"), std::string::npos) << shown.err;
  EXPECT_FALSE(cv::imread(out_.path("images/000004_input.png")).empty());
}

TEST_F(RunFolder, CutShortIsToldOnceByEveryCommand) {
  for (const char* name : {"none", "stillpoint"})
    out_.truncate(std::string("runs/") + name + "/records.bin", 0.6);
  const std::string one = run("stillpoint"), none = run("none");
  const auto times_told = [](const std::string& text, const std::string& folder) {
    int times = 0;
    const std::string part = folder + "/records.bin: is cut short";
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++times;
    return times;
  };
  // The baseline beside it is another run that is cut short.
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"snapshot", one, "--panels", "mask", "--out", out_.path("pictures")},
        {"snapshot", one, "--run", one, "--panels", "mask", "--out", out_.path("twice")},
        {"figures", one, "--frame", "1", "--out", out_.path("figures")},
        {"report", one, none, "--out", out_.path("r.html")},
        {"report", one, none, "--interactive", "--out", out_.path("live.html")},
        {"export", one, "--to", out_.path("run.mcap")},
        {"export", one, "--dense", out_.path("room.ply")}}) {
    const CliResult result = run_cli(words);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(times_told(result.err, one), 1) << words[0] << ": " << result.err;
    EXPECT_EQ(times_told(result.err, none), words[0] == "export" ? 0 : 1) << words[0] << ": " << result.err;
  }
}

TEST_F(RunFolder, WhatIsWrongIsToldInOneSentence) {
  expect_one_sentence(snapshot({"--method", "paper"}), "is a finished run, which has its own configuration");
  expect_one_sentence(snapshot({"--baseline", out_.path("nothing")}), "nothing: there is no such folder");
  expect_one_sentence(snapshot({"--sequence", out_.path("nothing")}), "nothing");
  expect_one_sentence(
      run_cli({"snapshot", sequence_.path(), "--baseline", run("none"), "--out", out_.path("i")}),
      "goes with a finished run's folder");
  out_.truncate("runs/stillpoint/records.bin", 0.001);
  for (const char* command : {"snapshot", "report"})
    expect_one_sentence(run_cli({command, run("stillpoint"), "--out", out_.path("x")}),
                        "is cut short after 0");
  expect_one_sentence(run_cli({"view", run("stillpoint")}), "is cut short after 0");
  fs::remove(run("stillpoint") + "/records.bin");
  expect_one_sentence(snapshot({}), "has no records.bin");
}

TEST_F(RunFolder, ReportIsOnePageThatNeedsNothingElse) {
  const CliResult made = run_cli({"report", run("none"), run("stillpoint"), "--out", page(), "--worst", "1"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const std::string html = out_.read("report.html");
  // Both runs, their worst frames, figures of the trajectory and what differs from the defaults.
  for (const char* part : {">none<",
                           ">stillpoint<",
                           "Worst frames of none",
                           "Worst frames of stillpoint",
                           "Mean milliseconds a frame, decoding excluded.",
                           "Error over time",
                           "Trajectories",
                           "Stage timings",
                           "run.method",
                           "All runs in one scale",
                           "Position x over time",
                           "The angle yaw over time",
                           "by every run",
                           "none: frame",
                           "stillpoint: frame",
                           "What this is of",
                           "Page made on",
                           "stillpoint report",
                           "Did removal help?",
                           "not checked (run.check_removal)",
                           "Camera"})
    EXPECT_THAT(html, HasSubstr(part));
  // The table leads to the frames, and each link leads somewhere.
  const std::string summary = html.substr(html.find("Worst frame<"));
  EXPECT_THAT(summary, HasSubstr("<a href=\"#frame"));
  for (std::size_t at = html.find("href=\"#"); at != std::string::npos; at = html.find("href=\"#", at + 1)) {
    const std::size_t begin = at + 7, end = html.find('"', begin);
    EXPECT_THAT(html, HasSubstr("id=\"" + html.substr(begin, end - begin) + "\""));
  }
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("http://"), std::string::npos);
  EXPECT_EQ(html.find("https://"), std::string::npos);
  // Each picture lies in the page, and is one.
  std::size_t images = 0;
  for (std::size_t at = html.find("<img"); at != std::string::npos; at = html.find("<img", at + 1)) {
    ++images;
    const std::size_t data = html.find(";base64,", at), end = html.find('"', data);
    ASSERT_LT(data, at + 40) << html.substr(at, 80);
    const std::string bytes = html.substr(data + 8, end - data - 8);
    EXPECT_EQ(bytes.size() % 4, 0U);
    EXPECT_EQ(bytes.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/="),
              std::string::npos);
    const bool png = bytes.starts_with("iVBORw0KGgo"), jpeg = bytes.starts_with("/9j/");  // their signatures
    EXPECT_TRUE(png || jpeg) << bytes.substr(0, 20);
  }
  EXPECT_GT(images, 6U);

  expect_one_sentence(run_cli({"report", run("none"), "--out", page()}), "--force");
  expect_one_sentence(run_cli({"report", run("none"), run("none"), "--out", page(), "--force"}),
                      "is named twice");
  expect_one_sentence(run_cli({"report", sequence_.path(), "--out", page(), "--force"}),
                      "has no records.bin");
  expect_one_sentence(run_cli({"report", run("none"), "--out", out_.path()}), "is a folder");
  expect_one_sentence(run_cli({"report", run("none"), "--out", out_.path("no/where.html")}),
                      "there is no folder");
}

TEST_F(RunFolder, AFullDiskIsToldOnce) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full to stand for a full disk";
  fs::create_symlink("/dev/full", page());
  const CliResult reported = run_cli({"report", run("none"), "--worst", "0", "--out", page(), "--force"});
  expect_one_sentence(reported, "report.html: cannot be written (No space left on device)");
  fs::create_directories(out_.path("images"));
  fs::create_symlink("/dev/full", out_.path("images/000003_input.png"));
  const CliResult drawn = snapshot({"--frames", "3", "--panels", "input", "--force"});
  EXPECT_EQ(drawn.exit_code, 1);
  EXPECT_THAT(drawn.err, HasSubstr("000003_input.png: cannot be written"));
}

TEST_F(RunFolder, OpensInAWindow) {
  const stillpoint::testing::Xvfb xvfb;
  if (!xvfb.running()) GTEST_SKIP() << "Xvfb is not installed";
  ::setenv("XDG_CONFIG_HOME", out_.path("config").c_str(), 1);
  CliProcess window({"view", run("stillpoint")});
  std::this_thread::sleep_for(std::chrono::seconds(3));
  window.send(SIGTERM);
  const CliResult result = window.wait();
  ::unsetenv("XDG_CONFIG_HOME");
  EXPECT_EQ(result.exit_code, 128 + SIGTERM) << result.err;
  EXPECT_FALSE(result.by_signal);
  EXPECT_THAT(out_.read("config/stillpoint/settings.json"), HasSubstr("runs/stillpoint"));
}

TEST_F(RunFolder, AReportTellsWhyRunsOfOneSequenceStandApart) {
  for (const char* frames : {"5", "8"})
    ASSERT_EQ(run_cli({"run", sequence_.path(), "--frames", frames, "--out", out_.path(frames)}).exit_code,
              0);
  const CliResult made = run_cli({"report", out_.path("5"), out_.path("8"), "--out", page(), "--worst", "2"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const std::string html = out_.read("report.html");
  for (const char* part : {", 5 frames</a>", ", 8 frames</a>", ", 5 frames</h2>", "they stand apart",
                           "Each is 10 frames or more from a worse one."})
    EXPECT_THAT(html, HasSubstr(part));
}

TEST(Report, ForeignTextIsNoMarkup) {
  const SmallSequence sequence(4);
  const std::string odd = sequence.path() + "_<b>&\"x\"";
  fs::copy(sequence.path(), odd, fs::copy_options::recursive);
  const TemporaryFolder out("out");
  ASSERT_EQ(run_cli({"run", odd, "--method", "none", "--out", out.path("run")}).exit_code, 0);
  ASSERT_EQ(run_cli({"report", out.path("run"), "--out", out.path("r.html")}).exit_code, 0);
  const std::string html = out.read("r.html");
  EXPECT_THAT(html, HasSubstr("&lt;b&gt;&amp;&quot;x&quot;"));
  EXPECT_EQ(html.find("<b>"), std::string::npos);
}

TEST(Video, HoldsAFrameForEachFrame) {
  const SmallSequence sequence(6);
  for (const char* ending : {"mp4", "mkv", "avi"}) {
    const std::string file = sequence.path(std::string("film.") + ending);
    const CliResult made =
        run_cli({"snapshot", sequence.path(), "--frames", "1:5", "--panels", "input", "--size",
                 std::string(ending) == "avi" ? "401x301" : "402x302", "--fps", "5", "--video", file});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    cv::VideoCapture video(file, cv::CAP_FFMPEG);
    EXPECT_DOUBLE_EQ(video.get(cv::CAP_PROP_FPS), 5.0);
    cv::Mat image;
    int images = 0;
    while (video.read(image)) {
      ++images;
      EXPECT_EQ(image.size(), std::string(ending) == "avi" ? cv::Size(401, 301) : cv::Size(402, 302));
      cv::Scalar mean, deviation;
      cv::meanStdDev(image, mean, deviation);
      EXPECT_GT(deviation[0], 5.0);
    }
    EXPECT_EQ(images, 4) << ending;
  }
  const auto wrong = [&](std::vector<std::string> more, const std::string& part) {
    std::vector<std::string> arguments = {"snapshot", sequence.path(), "--frames", "1:3"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    expect_one_sentence(run_cli(arguments), part);
  };
  wrong({"--video", sequence.path("film.gif")}, "ends in .mp4, .mkv or .avi");
  wrong({"--video", sequence.path("film.mp4")}, "--force");
  wrong({"--video", sequence.path("no/film.mp4")}, "there is no folder");
  wrong({"--video", sequence.path("odd.mp4"), "--panels", "input", "--size", "401x301"},
        "H.264 takes even sides alone, and the pictures are 401x301; --size 402x302");
  EXPECT_FALSE(fs::exists(sequence.path("odd.mp4")));
  wrong({"--video", sequence.path("two.mp4"), "--panels", "input,errors"}, "--panels names 2");
  expect_usage_error(run_cli({"snapshot", sequence.path(), "--frames", "1:3"}),
                     "--out or --video is required");
}

TEST(Video, ShowsFramesAtTheirOwnTimes) {
  const SmallSequence sequence(14);
  const std::string file = sequence.path("film.mkv");
  const CliResult made = run_cli({"snapshot", sequence.path(), "--frames", "1,2,5:14", "--panels", "input",
                                  "--size", "402x302", "--video", file});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  cv::VideoCapture video(file, cv::CAP_FFMPEG);
  for (const double frame : {1.0, 2.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0}) {
    ASSERT_TRUE(video.grab());
    EXPECT_NEAR(video.get(cv::CAP_PROP_POS_MSEC), (frame - 1.0) * 1000.0 / 30.0, 1.0) << frame;
  }
  EXPECT_FALSE(video.grab());
}

TEST(Figures, AreThePapersOfAnySequence) {
  const SmallSequence sequence(6);
  const std::string out = sequence.path("figures");
  const CliResult made = run_cli({"figures", sequence.path(), "--frame", "4", "--out", out});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  for (const char* name : {"1", "3", "4", "6"})
    EXPECT_FALSE(cv::imread(out + "/figure" + name + ".png").empty()) << name;
  for (const char* letter : {"a", "b", "c", "d", "e", "f"})
    EXPECT_EQ(cv::imread(out + "/figure1" + letter + ".png").size(), cv::Size(320, 240)) << letter;
  EXPECT_EQ(cv::norm(cv::imread(out + "/figure1b.png"), cv::imread(sequence.path("rgb/4.png")), cv::NORM_INF),
            0.0);

  // Captions have room whatever the pictures' size: narrower ones wrap into more lines.
  const int whole = cv::imread(out + "/figure1.png").rows;
  const CliResult small =
      run_cli({"figures", sequence.path(), "--frame", "4", "--scale", "0.5", "--out", out, "--force"});
  ASSERT_EQ(small.exit_code, 0) << small.err;
  EXPECT_GT(cv::imread(out + "/figure1.png").rows, whole - 2 * 120);

  // Of a method that has a compensated frame of its own figure 1 shows the paper's masks, as of any other.
  const CliResult other =
      run_cli({"figures", sequence.path(), "--frame", "4", "--method", "yi2013", "--out", out, "--force"});
  EXPECT_THAT(other.out,
              HasSubstr("figure1.png: frames, compensated frame, forward, backward and union mask by "
                        "method paper of"));
  EXPECT_THAT(other.out, HasSubstr("features before removal, those that method yi2013 removes told apart"));

  expect_one_sentence(run_cli({"figures", sequence.path(), "--frame", "4", "--out", out}), "--force");
  expect_one_sentence(run_cli({"figures", sequence.path(), "--frame", "9", "--out", out}),
                      "--frame 9: the sequence has frames 0 to 5");
  expect_one_sentence(run_cli({"figures", sequence.path(), "--frame", "1:3", "--out", out}),
                      "names 2 frames");
  fs::remove(sequence.path("depth.txt"));
  const CliResult colour = run_cli({"figures", sequence.path(), "--frame", "0", "--out", out, "--force"});
  EXPECT_EQ(colour.exit_code, 0) << colour.err;
  EXPECT_THAT(colour.out, HasSubstr("figure 1 is left out"));
  EXPECT_THAT(colour.out, HasSubstr("figure 6 is left out"));
}

}  // namespace
}  // namespace stillpoint
