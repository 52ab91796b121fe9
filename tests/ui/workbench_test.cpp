// The whole interface over a small sequence: offscreen, and in a window under Xvfb.
#include "ui/workbench/workbench.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "core/run/removal_errors.hpp"
#include "core/run/sweep.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/xvfb.hpp"
#include "ui/session/session.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/shell/window.hpp"
#include "ui/workbench/settings.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kWorkbenchFrames = 8;

/// A session at a frame. Times, which differ from run to run, are left out.
std::unique_ptr<Session> session_at(const SmallSequence& folder, int frame) {
  auto session =
      std::make_unique<Session>(open_sequence(folder.path()), Config{}, SessionOptions{.keep_times = false});
  session->go_to(frame);
  return session;
}

KeyChanged press(Key key, Modifiers modifiers = {}) { return {key, true, modifiers}; }
KeyChanged release(Key key, Modifiers modifiers = {}) { return {key, false, modifiers}; }

template <typename Shell>
void strike(Shell& shell, Key key, Modifiers modifiers = {}) {
  shell.send(press(key, modifiers));
  shell.send(release(key, modifiers));
}

class WorkbenchTest : public ::testing::Test {
 protected:
  ~WorkbenchTest() override { offscreen_.make_current(); }

  cv::Mat render(Workbench& workbench, const Session& session) {
    const auto view = session.view();
    return offscreen_.render([&](UiFrame& frame) { workbench.draw(frame, view.get()); });
  }

  SmallSequence folder_{kWorkbenchFrames};
  Offscreen offscreen_{{.width = 1280, .height = 800}};
};

TEST_F(WorkbenchTest, DrawsTheSameBytesTwice) {
  cv::Mat images[2];
  for (cv::Mat& image : images) {
    Offscreen offscreen({.width = 1280, .height = 800});
    Workbench workbench(make_panels());
    const auto session = session_at(folder_, 5);
    const auto view = session->view();
    image = offscreen.render([&](UiFrame& frame) { workbench.draw(frame, view.get()); });
    EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
    offscreen.make_current();
  }
  EXPECT_FALSE(is_blank(images[0], 50));
  EXPECT_EQ(cv::norm(images[0], images[1], cv::NORM_INF), 0.0);
}

TEST_F(WorkbenchTest, EachPanelAloneIsNotBlank) {
  const auto session = session_at(folder_, 5);
  const auto view = session->view();
  auto panels = make_panels();
  for (const auto& panel : panels) {
    // More colours than the heading's letters have: the panel itself draws.
    const cv::Mat image =
        offscreen_.render([&](UiFrame& frame) { Workbench::draw_alone(frame, *view, *panel); });
    EXPECT_FALSE(is_blank(image(cv::Rect(8, 40, 1260, 740)), 20)) << panel->name();
  }
  EXPECT_THAT(offscreen_.take_gl_errors(), IsEmpty());
}

TEST_F(WorkbenchTest, ColourAloneIsEnoughForMotion) {
  folder_.folder.write("depth.txt", "");
  const SmallSequence& colour_only = folder_;
  std::filesystem::remove(colour_only.path("depth.txt"));
  std::filesystem::remove(colour_only.path("groundtruth.txt"));
  const auto session = session_at(colour_only, 3);
  session->request(request::StagesBeside{"paper"});
  EXPECT_FALSE(session->view()->current->motion_beside->stages.empty());
  Workbench workbench(make_panels());
  EXPECT_FALSE(is_blank(render(workbench, *session), 50));
}

TEST_F(WorkbenchTest, StartsWithAPageThatOffersTheDemo) {
  std::vector<std::string> opened;
  Workbench workbench(make_panels(), {.open = [&](const std::string& where) { opened.push_back(where); }});
  const FrameFunction draw = [&](UiFrame& frame) { workbench.draw(frame, nullptr); };
  EXPECT_FALSE(is_blank(offscreen_.render(draw), 20));
  EXPECT_TRUE(workbench.actions().run("open_demo"));
  offscreen_.draw(draw);
  EXPECT_THAT(opened, ElementsAre("generated:walking_static"));
}

TEST_F(WorkbenchTest, KeysDoWhatTheySay) {
  const auto session = session_at(folder_, 5);
  std::vector<int> gone_to;
  std::vector<bool> played;
  Workbench workbench(make_panels(), {.go_to_frame = [&](int frame) { gone_to.push_back(frame); },
                                      .play = [&](bool play) { played.push_back(play); }});
  strike(offscreen_, Key::kRight);
  strike(offscreen_, Key::kLeft);
  strike(offscreen_, Key::kHome);
  strike(offscreen_, Key::kEnd, {.ctrl = true});
  strike(offscreen_, Key::kSpace);
  render(workbench, *session);
  EXPECT_THAT(gone_to, ElementsAre(6, 4, 0, kWorkbenchFrames - 1));
  EXPECT_THAT(played, ElementsAre(true));
}

TEST_F(WorkbenchTest, EachPressIsAStepFromWhereTheLastOneLed) {
  const auto session = session_at(folder_, 5);
  std::vector<int> gone_to, steps;
  Workbench workbench(make_panels(), {.go_to_frame = [&](int frame) { gone_to.push_back(frame); },
                                      .step = [&](int by) { steps.push_back(by); }});
  for (int press = 0; press < 3; ++press) strike(offscreen_, Key::kRight);
  strike(offscreen_, Key::kLeft);
  render(workbench, *session);
  EXPECT_THAT(steps, ElementsAre(1, 1, 1, -1));  // the session knows where to
  EXPECT_THAT(gone_to, ::testing::IsEmpty());
}

TEST_F(WorkbenchTest, PlaySaysHowManyFramesWereNotShown) {
  const auto session = session_at(folder_, 7);
  Workbench workbench(make_panels(), {.play = [](bool) {}});
  const auto show = [&](int index, bool playing) {
    session->go_to(index);
    SessionView view = *session->view();
    view.playing = playing;
    offscreen_.draw([&](UiFrame& frame) { workbench.draw(frame, &view); });
    return workbench.fact("dropped", &view).value();
  };
  EXPECT_EQ(show(0, true), "0");
  EXPECT_EQ(show(1, true), "0");
  EXPECT_EQ(show(4, true), "2");
  EXPECT_EQ(show(5, true), "2");
  EXPECT_EQ(show(7, true), "3");
  EXPECT_EQ(show(2, true), "3") << "round again in a range is no drop";
  EXPECT_EQ(show(2, false), "3");
  EXPECT_THAT(workbench.message(), HasSubstr("3 frames not shown"));
  // Where one goes by hand nothing is dropped.
  EXPECT_EQ(show(6, false), "3");
  EXPECT_EQ(show(6, true), "0");
}

TEST_F(WorkbenchTest, ThePaletteFindsMethodsPresetsParametersAndSaysWhatCannotBeDone) {
  const auto session = session_at(folder_, 5);
  std::vector<SessionRequest> asked;
  Workbench workbench(
      make_panels(),
      {.go_to_frame = [](int) {}, .request = [&](const SessionRequest& wanted) { asked.push_back(wanted); }});
  const auto enter = [&](const std::string& query) {
    strike(offscreen_, Key::kP, {.ctrl = true, .shift = true});
    render(workbench, *session);
    for (const char letter : query) offscreen_.send(TextTyped{static_cast<unsigned>(letter)});
    strike(offscreen_, Key::kEnter);
    render(workbench, *session);
    render(workbench, *session);
    strike(offscreen_, Key::kEscape);
    render(workbench, *session);
  };
  enter("compare epipolar");
  ASSERT_EQ(asked.size(), 1U);
  EXPECT_EQ(std::get<request::AddGhost>(asked[0]).config.run.method, "epipolar");
  enter("run all paper");
  ASSERT_EQ(asked.size(), 2U);
  EXPECT_EQ(std::get<request::RunAll>(asked[1]).config.run.method, "paper");
  enter("preset " + preset_names().front());
  ASSERT_EQ(asked.size(), 3U);
  EXPECT_EQ(std::get<request::AddGhost>(asked[2]).name, preset_names().front());
  EXPECT_FALSE(contains(workbench.layout(), "parameters"));
  enter("parameter features.count");
  EXPECT_TRUE(contains(workbench.layout(), "parameters"));
  // Nothing was marked, so that cannot be taken back: it is found, and does nothing.
  const std::size_t before = asked.size();
  enter("take back the last change of marks");
  EXPECT_EQ(asked.size(), before);
}

TEST_F(WorkbenchTest, ThePaletteFindsAndRuns) {
  const auto session = session_at(folder_, 5);
  std::vector<int> gone_to;
  Workbench workbench(make_panels(), {.go_to_frame = [&](int frame) { gone_to.push_back(frame); }});
  strike(offscreen_, Key::kP, {.ctrl = true, .shift = true});
  render(workbench, *session);
  EXPECT_TRUE(workbench.palette_open());
  for (const char letter : std::string("step b")) offscreen_.send(TextTyped{static_cast<unsigned>(letter)});
  strike(offscreen_, Key::kEnter);
  render(workbench, *session);
  EXPECT_FALSE(workbench.palette_open());
  EXPECT_THAT(gone_to, ElementsAre(4));

  strike(offscreen_, Key::kP, {.ctrl = true, .shift = true});
  render(workbench, *session);
  offscreen_.send(TextTyped{'7'});
  strike(offscreen_, Key::kEnter);
  render(workbench, *session);
  EXPECT_THAT(gone_to, ElementsAre(4, 7));

  strike(offscreen_, Key::kP, {.ctrl = true, .shift = true});
  strike(offscreen_, Key::kEscape);
  render(workbench, *session);
  EXPECT_FALSE(workbench.palette_open());
}

TEST_F(WorkbenchTest, PanelsAreHiddenMaximisedAndBroughtBack) {
  const auto session = session_at(folder_, 5);
  Workbench workbench(make_panels());
  const LayoutNode before = workbench.layout();
  render(workbench, *session);
  EXPECT_TRUE(workbench.actions().run("panel.errors"));
  render(workbench, *session);
  EXPECT_THAT(panels_of(workbench.layout()), Not(Contains("errors")));
  EXPECT_TRUE(workbench.actions().run("reset_layout"));
  render(workbench, *session);
  EXPECT_EQ(workbench.layout(), before);
  // What method `stillpoint` finds lies in the middle of the upper half.
  offscreen_.send(MouseMoved{500, 300});
  render(workbench, *session);
  strike(offscreen_, Key::kM);
  render(workbench, *session);
  EXPECT_EQ(workbench.maximised(), "motion");
  strike(offscreen_, Key::kM);
  render(workbench, *session);
  EXPECT_EQ(workbench.maximised(), "");
}

TEST_F(WorkbenchTest, SplittersAreDragged) {
  const auto session = session_at(folder_, 5);
  Workbench workbench(make_panels());
  render(workbench, *session);
  const LayoutNode before = workbench.layout();
  // Between the first two tiles of the upper row.
  offscreen_.send(MouseMoved{372.0F, 300.0F});
  offscreen_.send(MouseButton{0, true, {}});
  render(workbench, *session);
  offscreen_.send(MouseMoved{422.0F, 300.0F});
  render(workbench, *session);
  offscreen_.send(MouseButton{0, false, {}});
  render(workbench, *session);
  EXPECT_GT(workbench.layout().children[0].children[0].share, before.children[0].children[0].share + 0.03);
  EXPECT_EQ(workbench.layout().children[1], before.children[1]);
  // The whole drag is taken back at once.
  EXPECT_TRUE(workbench.actions().run("undo_layout"));
  render(workbench, *session);
  EXPECT_EQ(workbench.layout(), before);
  EXPECT_FALSE(workbench.actions().run("undo_layout"));
}

TEST(Settings, ComeBackAsTheyWereLeft) {
  const TemporaryFolder folder;
  Settings settings;
  settings.look = {ThemeName::kLight, 1.25F};
  settings.layout = default_layout();
  settings.window_size = std::array<int, 2>{1234, 777};
  const RecentSequence a{"a",
                         {"camera=freiburg3", "frames=60"},
                         {"run.method=paper"},
                         17,
                         {{"method none", {"run.method=none"}, 0}, {"later", {}, 5}},
                         {.pictures = RunPictures::wiped,
                          .ticked = {"method none"},
                          .left_out = {"paper"},
                          .flipped_to = "method none",
                          .hidden = {"none (baseline)"},
                          .dividers = {0.25F}}},
      b{"b", {}, {}};
  remember(settings.recent, {"a", {}, {}});
  remember(settings.recent, b);
  remember(settings.recent, a);
  const std::string path = folder.path("deep/settings.json");
  write_settings(path, settings);
  std::string problem;
  const Settings read = read_settings(path, panels_of(default_layout()), &problem);
  EXPECT_EQ(problem, "");
  EXPECT_EQ(read.look, settings.look);
  EXPECT_EQ(read.layout, settings.layout);
  EXPECT_EQ(read.window_size, settings.window_size);
  EXPECT_THAT(read.recent, ElementsAre(a, b));
  EXPECT_EQ(read_layout(path, panels_of(default_layout())), default_layout());
}

TEST(Settings, PathsOfEarlierVersionsAreRecentSequences) {
  const TemporaryFolder folder;
  folder.write("settings.json", std::string(R"({"recent": ["x", "y"]})"));
  std::string problem;
  const Settings read = read_settings(folder.path("settings.json"), {}, &problem);
  EXPECT_EQ(problem, "");
  EXPECT_THAT(read.recent, ElementsAre(RecentSequence{"x", {}, {}}, RecentSequence{"y", {}, {}}));
}

TEST(Settings, DividersOutOfOrderAreEqualStripsAgain) {
  const TemporaryFolder folder;
  for (const char* dividers : {"[0.7, 0.2]", "[-1]", "[0.5, 2]"}) {
    folder.write(
        "settings.json",
        fmt::format(R"({{"recent": [{{"where": "a", "runs": {{"pictures": "wipe", "dividers": {}}}}}]}})",
                    dividers));
    const Settings read = read_settings(folder.path("settings.json"), {});
    ASSERT_EQ(read.recent.size(), 1U) << dividers;
    EXPECT_EQ(read.recent[0].runs.pictures, RunPictures::wiped);
    EXPECT_TRUE(read.recent[0].runs.dividers.empty()) << dividers;
  }
}

TEST(Settings, DamagedOnesGiveTheDefaults) {
  const TemporaryFolder folder;
  std::string problem;
  EXPECT_EQ(read_settings(folder.path("none.json"), {}, &problem).look, Look{});
  EXPECT_EQ(problem, "");
  for (const char* text : {"{", "[]", R"({"theme": "pink"})", R"({"recent": 3})", R"({"window": [1]})"}) {
    folder.write("settings.json", std::string(text));
    problem.clear();
    EXPECT_EQ(read_settings(folder.path("settings.json"), {}, &problem).look, Look{}) << text;
    EXPECT_NE(problem, "") << text;
  }
}

TEST(WorkbenchWindow, PlaysTakesKeysAndCloses) {
  const Xvfb xvfb;
  if (!xvfb.running()) GTEST_SKIP() << "Xvfb is not installed";
  const SmallSequence folder(kWorkbenchFrames);
  Window window({.width = 1000, .height = 700});
  std::vector<std::string> opened;
  auto session = std::make_unique<Session>(open_sequence(folder.path()), Config{});
  session->start([] { Window::wake(); });
  session->request_speed(1000);
  Workbench workbench(make_panels(), {.go_to_frame = [&](int frame) { session->request_frame(frame); },
                                      .play = [&](bool play) { session->request_play(play); },
                                      .open = [&](const std::string& where) { opened.push_back(where); }});
  const FrameFunction draw = [&](UiFrame& frame) {
    const auto view = session->view();
    workbench.draw(frame, view.get());
  };
  const auto draw_until = [&](auto&& holds) {
    for (int i = 0; i < 2000 && !holds(); ++i) {
      window.draw(draw);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return holds();
  };
  strike(window, Key::kSpace);
  EXPECT_TRUE(draw_until([&] { return session->view()->current->index == kWorkbenchFrames - 1; }));
  strike(window, Key::kHome);
  EXPECT_TRUE(draw_until([&] { return session->view()->current->index == 0; }));
  strike(window, Key::kRight);
  EXPECT_TRUE(draw_until([&] { return session->view()->current->index == 1; }));
  strike(window, Key::kSlash, {.shift = true});
  EXPECT_TRUE(draw_until([&] { return workbench.shortcuts_open(); }));
  EXPECT_FALSE(is_blank(window.capture(draw), 50));
  EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
  strike(window, Key::kQ, {.ctrl = true});
  bool quit = false;
  for (int i = 0; i < 10 && !quit; ++i) quit = window.draw(draw).quit;
  EXPECT_TRUE(quit);
  session.reset();
}

}  // namespace
}  // namespace stillpoint::testing
