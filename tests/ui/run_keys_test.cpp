// Which runs are seen: chosen by keys and by the palette, hidden and brought back.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/odometry/frame_record.hpp"
#include "core/run/frame_figures.hpp"
#include "tests/ui/three_runs.hpp"
#include "ui/panels/panel_choices.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

/// The workbench with three runs, its keys and its palette.
class RunKeys : public ::testing::Test {
 protected:
  RunKeys() : workbench_(make_panels(), {.request = [](const SessionRequest&) {}}) {}
  ~RunKeys() override { offscreen_.make_current(); }
  void draw() {
    offscreen_.draw([this](UiFrame& frame) { workbench_.draw(frame, &session_); });
  }
  void strike(Key key, Modifiers modifiers = {}) {
    offscreen_.send(KeyChanged{key, true, modifiers});
    draw();
    offscreen_.send(KeyChanged{key, false, {}});
    draw();
    draw();
  }
  [[nodiscard]] std::string runs() const { return workbench_.fact("runs", &session_).value_or(""); }

  SessionView session_ = three_runs();
  Offscreen offscreen_{{.width = 1280, .height = 800}};
  Workbench workbench_;
};

TEST_F(RunKeys, WipeAndFlip) {
  draw();
  EXPECT_EQ(runs(), "alone");
  strike(Key::kW);
  EXPECT_EQ(runs(), "wipe stillpoint none (baseline) motion.border_px 7 method none");
  strike(Key::kF);
  EXPECT_EQ(runs(), "flip stillpoint none (baseline)* motion.border_px 7 method none");
  strike(Key::kF);
  EXPECT_EQ(runs(), "flip stillpoint none (baseline) motion.border_px 7* method none");
  strike(Key::kF);
  strike(Key::kF);
  EXPECT_EQ(runs(), "flip stillpoint* none (baseline) motion.border_px 7 method none");
  strike(Key::kF, {.shift = true});
  EXPECT_EQ(runs(), "flip stillpoint none (baseline) motion.border_px 7 method none*");
  strike(Key::kW);
  strike(Key::kW);
  EXPECT_EQ(runs(), "alone");
}

TEST_F(RunKeys, AKeyThatCanDoNothingSaysWhyAndHowToGoOn) {
  session_.debug.ghosts.clear();
  session_.baseline = nullptr;
  draw();
  for (const Key key : {Key::kW, Key::kF}) {
    strike(key);
    EXPECT_EQ(runs(), "alone");
    EXPECT_EQ(workbench_.message(),
              "There is no second run: \"Compare with method …\" in the palette (Ctrl+Shift+P) adds one.");
  }
  // Once there is one, nothing stands in the way any more.
  session_.debug.ghosts = three_runs().debug.ghosts;
  draw();
  EXPECT_EQ(workbench_.message(), "");
  strike(Key::kW);
  EXPECT_EQ(runs(), "wipe stillpoint motion.border_px 7 method none");
  RunsShown shown = workbench_.runs();
  shown.left_out = {"motion.border_px 7", "method none"};
  workbench_.set_runs(shown);
  strike(Key::kF);
  EXPECT_EQ(workbench_.message(), "Only stillpoint is ticked: tick another run in Compare runs.");
  // What is on is put off, whatever is left.
  strike(Key::kW);
  EXPECT_EQ(runs(), "alone");
}

TEST_F(RunKeys, TheBaselineIsAskedForItsPicturesWhereTheyAreShown) {
  std::vector<bool> told;
  Workbench workbench(make_panels(), {.baseline = [&](bool wanted) { told.push_back(wanted); }});
  const auto draw_again = [&] {
    offscreen_.draw([&](UiFrame& frame) { workbench.draw(frame, &session_); });
    return told.back();
  };
  EXPECT_FALSE(draw_again());
  workbench.set_runs({.pictures = RunPictures::wiped});
  EXPECT_TRUE(draw_again());
  workbench.set_runs({.pictures = RunPictures::wiped, .left_out = {"none (baseline)"}});
  EXPECT_FALSE(draw_again());
  offscreen_.make_current();
}

TEST_F(RunKeys, ThePaletteChoosesAmongRuns) {
  strike(Key::kW);
  strike(Key::kP, {.ctrl = true, .shift = true});
  ASSERT_TRUE(workbench_.palette_open());
  for (const char letter : std::string("leave border out")) {
    offscreen_.send(TextTyped{static_cast<unsigned char>(letter)});
    draw();
  }
  draw();
  strike(Key::kEnter);
  EXPECT_EQ(runs(), "wipe stillpoint none (baseline) method none");
  // One run alone has nothing to be wiped against.
  session_.debug.ghosts.clear();
  session_.baseline = nullptr;
  draw();
  EXPECT_FALSE(workbench_.actions().run("flip_runs"));
}

TEST_F(RunKeys, ThePaletteGoesOnAfterAnEnterThatFoundNothing) {
  const auto type = [this](const std::string& text) {
    for (const char letter : text) {
      offscreen_.send(TextTyped{static_cast<unsigned char>(letter)});
      draw();
    }
    draw();
  };
  strike(Key::kP, {.ctrl = true, .shift = true});
  type("qqq");
  strike(Key::kEnter);
  EXPECT_TRUE(workbench_.palette_open());
  for (int i = 0; i < 3; ++i) strike(Key::kBackspace);
  type("wipe runs against");
  strike(Key::kEnter);
  EXPECT_FALSE(workbench_.palette_open());
  EXPECT_EQ(workbench_.runs().pictures, RunPictures::wiped);
}

TEST_F(RunKeys, AHiddenRunIsLeftOutOfPlotsAndIsStillListed) {
  const auto picture = [this] {
    draw();
    return offscreen_.render([this](UiFrame& frame) { workbench_.draw(frame, &session_); });
  };
  for (const char* panel : {"errors", "compare"}) {
    workbench_.set_layout({.panel = panel});
    workbench_.set_runs({});
    const cv::Mat all = picture();
    workbench_.set_runs({.hidden = {"motion.border_px 7"}});
    const cv::Mat fewer = picture();
    EXPECT_GT(cv::norm(all, fewer, cv::NORM_INF), 50.0) << panel;
    if (std::string(panel) == "compare") continue;
    // The one that is left has the colour it had.
    const Rgb green = okabe_ito::kGreen, purple = okabe_ito::kPurple;
    const auto count = [](const cv::Mat& image, Rgb colour) {
      cv::Mat there;
      cv::inRange(image, cv::Scalar(colour.b, colour.g, colour.r), cv::Scalar(colour.b, colour.g, colour.r),
                  there);
      return cv::countNonZero(there);
    };
    EXPECT_GT(count(all, purple), 20);
    EXPECT_GT(count(fewer, green), 20);
    EXPECT_EQ(count(fewer, purple), 0);
  }
}

TEST_F(RunKeys, AHiddenBaselineLeavesTheTrajectoryAndComesBackByTheList) {
  session_.debug.ghosts.clear();
  const Rgb baseline = role_colour(Role::kBaseline, ThemeName::kDark);
  const auto picture = [this](const char* panel, const std::vector<std::string>& hidden) {
    if (panels_of(workbench_.layout()) != std::vector<std::string>{panel})
      workbench_.set_layout({.panel = panel});
    RunsShown runs;
    runs.hidden = hidden;
    workbench_.set_runs(runs);
    draw();
    return offscreen_.render([this](UiFrame& frame) { workbench_.draw(frame, &session_); });
  };
  const auto count = [&](const cv::Mat& image) {
    cv::Mat there;
    const cv::Scalar colour(baseline.b, baseline.g, baseline.r);
    cv::inRange(image, colour, colour, there);
    return cv::countNonZero(there);
  };
  EXPECT_GT(count(picture("trajectory", {})), 20);
  EXPECT_EQ(count(picture("trajectory", {"none (baseline)"})), 0);
  EXPECT_GT(count(picture("trajectory", {})), 20);
  // The list has it whether hidden or not.
  EXPECT_GT(count(picture("compare", {"none (baseline)"})), 5);
}

}  // namespace
}  // namespace stillpoint::testing
