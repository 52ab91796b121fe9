// The panels of debugging: what they show of a session put together by hand, and what they ask of it.
#include <set>

#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/motion/paper/paper_config.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "core/run/worst_frames.hpp"
#include "tests/support/golden.hpp"
#include "tests/ui/panel_stage.hpp"
#include "tests/ui/session_example.hpp"
#include "ui/session/data_sources.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

constexpr int kSheetWidth = 640, kSheetHeight = 420;

// Where things are in the panels at that size, as shares of it.
constexpr double kRulerY = 0.1, kSecondLaneY = 0.47;
constexpr double kNewY = 0.045, kFirstRowY = 0.115, kCheckX = 0.033, kPreviousHitX = 0.872, kNextHitX = 0.92,
                 kDeleteX = 0.967;
constexpr double kSecondNoteY = 0.19;
constexpr double kFirstGhostY = 0.174, kPartsX = 0.82, kRemoveX = 0.964;
constexpr double kWorstHurtY = 0.095;
constexpr double kFilterY = 0.045, kSliderX = 0.56, kSliderY = 0.288, kResetX = 0.96, kRunFromHereY = 0.245,
                 kDiscardX = 0.465;

/// The one request of a kind; fails where there are none or several.
template <typename Request>
Request only(const PanelActions& actions) {
  EXPECT_EQ(actions.requests.size(), 1U);
  if (actions.requests.empty() || !std::holds_alternative<Request>(actions.requests.front())) {
    ADD_FAILURE() << "no request of this kind";
    return {};
  }
  return std::get<Request>(actions.requests.front());
}

std::vector<InputEvent> typed(const std::string& text) {
  std::vector<InputEvent> events;
  for (const char letter : text) events.emplace_back(TextTyped{static_cast<unsigned char>(letter)});
  return events;
}

std::vector<InputEvent> struck(Key key, Modifiers modifiers = {}) {
  return {KeyChanged{key, true, modifiers}, KeyChanged{key, false, modifiers}};
}

TEST(DebugPanels, GoldenImages) {
  const SessionView example = debug_example();
  for (const auto& [name, theme] : {std::pair{"timeline", ThemeName::kDark},
                                    {"breakpoints", ThemeName::kLight},
                                    {"bookmarks", ThemeName::kDark},
                                    {"compare", ThemeName::kLight},
                                    {"removal", ThemeName::kDark},
                                    {"errors", ThemeName::kLight}}) {
    PanelStage stage(name, {theme, 1.0F}, kSheetWidth, kSheetHeight);
    EXPECT_TRUE(matches_golden(stage.render(example), std::string("debug_") + name));
  }
}

TEST(DebugPanels, PosesTooFewToAlignHaveNoAbsoluteError) {
  const std::string why = "2 matched poses, and an alignment needs 3";
  for (const char* name : {"errors", "trajectory"}) {
    const auto picture = [name](double rmse_m, const std::string& why_none) {
      SessionView example = handmade_example();
      const auto original = example.run;  // the view points into its records
      auto run = std::make_shared<RunView>(*original);
      run->evaluation.ate.translation_m.rmse = rmse_m;
      run->evaluation.ate.why_none = why_none;
      example.run = run;
      PanelStage stage(name, {ThemeName::kDark, 1.0F}, kSheetWidth, kSheetHeight);
      return stage.render(example).clone();
    };
    const cv::Mat none = picture(0.0, why);
    EXPECT_EQ(cv::norm(none, picture(0.004, why), cv::NORM_INF), 0) << name;
    EXPECT_GT(cv::norm(none, picture(0.0, ""), cv::NORM_INF), 0) << name << ": none is not 0 mm";
  }
}

/// The workbench over the example, with all that it asks for written down.
class DebugKeys : public ::testing::Test {
 protected:
  DebugKeys() : workbench_(make_panels(), host()) {}
  ~DebugKeys() override { offscreen_.make_current(); }

  WorkbenchHost host() {
    return {.go_to_frame = [this](int frame) { gone_to_.push_back(frame); },
            .request = [this](SessionRequest request) { asked_.push_back(std::move(request)); }};
  }
  void strike(Key key, Modifiers modifiers = {}) {
    for (const InputEvent& event : struck(key, modifiers)) {
      offscreen_.send(event);
      offscreen_.draw([this](UiFrame& frame) { workbench_.draw(frame, &session_); });
    }
  }

  SessionView session_ = debug_example();
  std::vector<int> gone_to_;
  std::vector<SessionRequest> asked_;
  Offscreen offscreen_{{.width = 1280, .height = 800}};
  Workbench workbench_;
};

std::vector<int> worst_of(const SessionView& session) {
  std::vector<int> frames;
  const MeasuredFrames measured = session.run->measured();
  for (const WorstFrame& frame : worst_frames(measured, usual_figure(measured)))
    frames.push_back(frame.index);
  return frames;
}

TEST_F(DebugKeys, LeadToWhatWentWrong) {
  const std::vector<int> worst = worst_of(session_);
  strike(Key::kN);
  strike(Key::kF8);
  strike(Key::kF8, {.shift = true});
  strike(Key::kJ);
  strike(Key::kJ, {.shift = true});
  strike(Key::kPeriod);
  strike(Key::kComma);
  strike(Key::kD);
  EXPECT_THAT(gone_to_, ElementsAre(worst.front(), 30, 21, 26, 13, 31, 5, 12));
}

TEST_F(DebugKeys, TheListOfWorstFramesIsGoneThrough) {
  const std::vector<int> worst = worst_of(session_);
  ASSERT_GE(worst.size(), 3U);
  const auto stand_at = [this](int frame) {
    auto current = std::make_shared<FrameView>(*session_.current);
    current->index = frame;
    session_.current = current;
  };
  stand_at(worst[1]);  // opened there, not led there: worse ones are not passed over
  strike(Key::kN);
  stand_at(worst[0]);
  strike(Key::kN);
  stand_at(worst[1]);
  strike(Key::kN);
  stand_at(worst[2]);
  strike(Key::kN, {.shift = true});
  EXPECT_THAT(gone_to_, ElementsAre(worst[0], worst[1], worst[2], worst[1]));
}

TEST_F(DebugKeys, BookmarkAndRange) {
  strike(Key::kB);  // frame 24 has a bookmark without a note
  strike(Key::kI);
  strike(Key::kO);
  strike(Key::kL, {.ctrl = true});
  ASSERT_EQ(asked_.size(), 4U);
  EXPECT_EQ(std::get<request::Bookmarks>(asked_[0]).all.size(), 2U);
  // Frame 24 lies behind the range's end, 20: a range that begins there reaches to the sequence's end.
  EXPECT_EQ(std::get<request::Span>(asked_[1]).span, (FrameSpan{24, 59}));
  EXPECT_EQ(std::get<request::Span>(asked_[2]).span, (FrameSpan{10, 24}));
  EXPECT_TRUE(std::get<request::Span>(asked_[3]).loop);
}

TEST_F(DebugKeys, ANoteIsNotThrownAway) {
  session_.debug.bookmarks = {{24, "why"}};
  strike(Key::kB);
  EXPECT_THAT(asked_, IsEmpty());
  EXPECT_THAT(workbench_.message(), ::testing::HasSubstr("note"));
}

TEST_F(DebugKeys, LayoutsForEachKindOfWork) {
  Key key = Key::k1;
  ASSERT_GE(named_layouts().size(), 2U);
  for (const NamedLayout& layout : named_layouts()) {
    for (const char* method : {"paper", "stillpoint"}) {
      const std::vector<std::string> panels = panels_of(layout.make(method));
      EXPECT_THAT(panels, ::testing::Not(IsEmpty())) << layout.name;
      EXPECT_EQ(std::set<std::string>(panels.begin(), panels.end()).size(), panels.size()) << layout.name;
      EXPECT_THAT(workbench_.panel_names(), IsSupersetOf(panels)) << layout.name;
    }
    strike(key, {.ctrl = true});
    EXPECT_EQ(panels_of(workbench_.layout()), panels_of(layout.make(session_.config.run.method)));
    key = static_cast<Key>(static_cast<int>(key) + 1);
  }
}

TEST_F(DebugKeys, WhatTheSessionWroteIsSaid) {
  session_.debug.notice = "11 frames written to worst";
  strike(Key::kB);
  EXPECT_EQ(workbench_.message(), "11 frames written to worst");
}

TEST(Timeline, ADragInTheTopRowSelectsARange) {
  SessionView session = debug_example();
  session.debug.span.reset();
  PanelStage stage("timeline", {}, kSheetWidth, kSheetHeight);
  const auto ruler = only<request::Span>(stage.drag(session, {0.4, kRulerY}, {0.6, kRulerY}, {}));
  ASSERT_TRUE(ruler.span);
  const auto shift = only<request::Span>(stage.drag(session, {0.6, 0.6}, {0.4, 0.6}, {.shift = true}));
  EXPECT_EQ(shift.span, ruler.span) << "in the lanes with Shift, and backwards, it is the same";
  EXPECT_GT(ruler.span->first, 5);
  EXPECT_LT(ruler.span->last, 55);
  // A fifth of the width is somewhat more than a quarter of the lanes' 60 frames.
  EXPECT_NEAR(ruler.span->last - ruler.span->first, 16, 3);
}

TEST(Timeline, AClickInTheTopRowGoesThere) {
  const SessionView session = debug_example();
  PanelStage stage("timeline", {}, kSheetWidth, kSheetHeight);
  const PanelActions actions = stage.click(session, 0.75, kRulerY);
  EXPECT_THAT(actions.requests, IsEmpty());
  EXPECT_TRUE(actions.go_to_frame);
}

TEST(Timeline, ALaneChosenDecidesWhatIsWorst) {
  const SessionView session = debug_example();
  PanelStage stage("timeline", {}, kSheetWidth, kSheetHeight);
  EXPECT_EQ(stage.click(session, 0.05, kSecondLaneY).worst_by, frame_figure("mask"));
}

TEST(Timeline, ThousandsOfFramesKeepTheirSpike) {
  // One bad frame among 3,000 on some 450 columns is seen: without it the image differs.
  PanelStage stage("timeline", {}, kSheetWidth, kSheetHeight);
  const cv::Mat spike = stage.render(long_example(3000, 1500));
  const cv::Mat none = stage.render(long_example(3000, -1));
  EXPECT_FALSE(images_agree(spike, none, {2, 20.0, 0.0}));
}

TEST(Breakpoints, OneIsAddedByTyping) {
  const SessionView session = debug_example();
  PanelStage stage("breakpoints", {}, kSheetWidth, kSheetHeight);
  stage.click(session, 0.2, kNewY);
  stage.play(session, typed("inliers < 40"));
  const auto added = only<request::Breakpoints>(stage.play(session, struck(Key::kEnter)));
  ASSERT_EQ(added.all.size(), session.debug.breakpoints.size() + 1);
  EXPECT_EQ(added.all.back(), (Breakpoint{"inliers < 40", true}));
}

TEST(Breakpoints, AWrongOneIsNotAdded) {
  const SessionView session = debug_example();
  PanelStage stage("breakpoints", {}, kSheetWidth, kSheetHeight);
  const cv::Mat before = stage.render(session);
  stage.click(session, 0.2, kNewY);
  stage.play(session, typed("inliers <"));
  EXPECT_THAT(stage.play(session, struck(Key::kEnter)).requests, IsEmpty());
  const cv::Rect below(0, static_cast<int>(kNewY * kSheetHeight) + 12, kSheetWidth, 24);
  EXPECT_FALSE(images_agree(stage.render(session)(below), before(below), {2, 100.0, 0.0}))
      << "what is wrong is said below";
}

TEST(Breakpoints, HitsAreGoneTo) {
  const SessionView session = debug_example();  // at frame 24; hits at 19, 20, 21 and 30, 31, 32
  PanelStage stage("breakpoints", {}, kSheetWidth, kSheetHeight);
  EXPECT_EQ(stage.click(session, kNextHitX, kFirstRowY).go_to_frame, 30);
  EXPECT_EQ(stage.click(session, kPreviousHitX, kFirstRowY).go_to_frame, 21);
}

TEST(Breakpoints, OneIsSwitchedOffAndDeleted) {
  const SessionView session = debug_example();
  PanelStage stage("breakpoints", {}, kSheetWidth, kSheetHeight);
  const auto off = only<request::Breakpoints>(stage.click(session, kCheckX, kFirstRowY));
  EXPECT_FALSE(off.all.at(0).enabled);
  EXPECT_TRUE(off.all.at(1).enabled);
  const auto left = only<request::Breakpoints>(stage.click(session, kDeleteX, kFirstRowY));
  EXPECT_EQ(left.all.size(), session.debug.breakpoints.size() - 1);
  EXPECT_EQ(left.all.at(0).expression, "lost");
}

TEST(Bookmarks, NotesAreWritten) {
  const SessionView session = debug_example();
  PanelStage stage("bookmarks", {}, kSheetWidth, kSheetHeight);
  stage.click(session, 0.5, kSecondNoteY);  // frame 24, without a note
  stage.play(session, typed("here"));
  const auto noted = only<request::Bookmarks>(stage.play(session, struck(Key::kEnter)));
  EXPECT_EQ(noted.all.at(1), (Bookmark{24, "here"}));
}

TEST(Compare, DivergenceIsGoneToAndGhostsAreRemoved) {
  const SessionView session = debug_example();
  PanelStage stage("compare", {}, kSheetWidth, kSheetHeight);
  EXPECT_EQ(stage.click(session, kPartsX, kFirstGhostY).go_to_frame, 12);
  EXPECT_EQ(only<request::RemoveGhost>(stage.click(session, kRemoveX, kFirstGhostY)).index, 0);
}

TEST(Removal, TheWorstHarmIsGoneTo) {
  const SessionView session = debug_example();
  PanelStage stage("removal", {}, kSheetWidth, kSheetHeight);
  const auto frame = stage.click(session, 0.06, kWorstHurtY).go_to_frame;
  ASSERT_TRUE(frame);
  EXPECT_THAT(hurt_frames(session.debug), ::testing::Contains(*frame));
}

TEST(Removal, IsCheckedWhenAskedFor) {
  SessionView session = debug_example();
  session.debug.removal = {};
  session.ground_truth = Trajectory{{0.0, Pose::Identity()}};
  PanelStage stage("removal", {}, kSheetWidth, kSheetHeight);
  EXPECT_EQ(only<request::RunAll>(stage.click(session, 0.06, 0.05)).config.run.check_removal, true);
}

TEST(ParametersPanel, AValueMovedIsPreviewedAndRunOnlyWhenAskedFor) {
  const SessionView session = debug_example();
  PanelStage stage("parameters", {}, kSheetWidth, kSheetHeight);
  stage.click(session, 0.1, kFilterY);
  stage.play(session, typed("border_px"));
  const PanelActions moved = stage.click(session, kSliderX, kSliderY);
  ASSERT_FALSE(moved.requests.empty());
  const auto preview = std::get<request::Preview>(moved.requests.back());
  ASSERT_TRUE(preview.config);
  EXPECT_NE(preview.config->of<PaperConfig>().border_px, session.config.of<PaperConfig>().border_px);
  // A bar with what can be done has come above the rows.
  const auto ghost = only<request::AddGhost>(stage.click(session, 0.08, kRunFromHereY));
  EXPECT_EQ(ghost.from, 24);
  EXPECT_EQ(ghost.config.of<PaperConfig>().border_px, preview.config->of<PaperConfig>().border_px);
  EXPECT_THAT(ghost.name, ::testing::StartsWith("paper.border_px"));
  EXPECT_FALSE(only<request::Preview>(stage.click(session, kDiscardX, kRunFromHereY)).config);
}

TEST(ParametersPanel, ResetGoesBackToTheDefault) {
  SessionView session = debug_example();
  session.config.of<PaperConfig>().border_px = 9;
  PanelStage stage("parameters", {}, kSheetWidth, kSheetHeight);
  stage.click(session, 0.1, kFilterY);
  stage.play(session, typed("border_px"));
  const auto preview = only<request::Preview>(stage.click(session, kResetX, kSliderY));
  ASSERT_TRUE(preview.config);
  EXPECT_EQ(preview.config->of<PaperConfig>().border_px, Config().of<PaperConfig>().border_px);
}

TEST(Bookmarks, NotesHaveTheRoomOfANarrowTile) {
  // Where the time would stand in a wider tile, a note is typed.
  const SessionView session = debug_example();
  PanelStage stage("bookmarks", {}, 280, 240);
  bool typed = false;
  for (float y = 40.0F; y < 110.0F && !typed; y += 8.0F) {
    stage.play(session, {MouseMoved{100.0F, y}, MouseButton{0, true, {}}, MouseButton{0, false, {}}});
    stage.play(session, {TextTyped{'z'}});
    for (const SessionRequest& request :
         stage.play(session, {KeyChanged{Key::kEnter, true, {}}, KeyChanged{Key::kEnter, false, {}}})
             .requests)
      if (const auto* marks = std::get_if<request::Bookmarks>(&request))
        for (const Bookmark& bookmark : marks->all) typed |= bookmark.note.find('z') != std::string::npos;
  }
  EXPECT_TRUE(typed);
}

}  // namespace
}  // namespace stillpoint::testing
