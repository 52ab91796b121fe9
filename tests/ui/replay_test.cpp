// The interface, tested by recordings: what a person does with it, played without a display.
#include "ui/workbench/replay.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "core/error.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/golden.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kReplayFrames = 8;

class Replay : public ::testing::Test {
 protected:
  /// Plays a recording on the small sequence. @returns what went wrong, "" when nothing did
  std::string play(const std::string& events, const std::string& start = "") {
    const Recording recording =
        parse_recording("stillpoint recording 1\n" + start + "idle\n" + events, "recording.txt");
    const std::string layout = recording.start.layout;
    Offscreen offscreen({.width = 1280, .height = 800});
    std::string problem;
    {
      AppController controller(
          {.open_source =
               [](const std::string& where, const Config& config, const std::vector<std::string>&) {
                 OpenedSource place{
                     .source = open_sequence(where), .config = config, .options = {}, .problem = {}};
                 place.options.keep_times = false;
                 return place;
               },
           .config = {},
           .settings = {},
           .marks_folder = {},
           .plays_when_opened = {},
           .wake = {}});
      if (!layout.empty())
        controller.workbench().set_layout(
            parse_layout(layout, recording.file, controller.workbench().panel_names()));
      if (opens_) controller.open(folder_.path());
      try {
        replay(recording, controller, replay_shell(offscreen),
               {.out = out_.path(), .patience_s = 60.0, .between = [] {}});
      } catch (const InputError& error) {
        problem = error.what();
      }
      offscreen.make_current();
    }
    EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
    return problem;
  }

  SmallSequence folder_{kReplayFrames};
  TemporaryFolder out_;
  bool opens_ = true;
};

TEST_F(Replay, KeysGoThroughTheSequence) {
  EXPECT_EQ(play(R"(expect frame 1
key Right
idle
expect frame 2
key Home
idle
expect frame 0
key Left
idle
expect frame 0
key Ctrl+End
idle
expect frame 7
expect processed 8
expect status tracked
expect playing no
frame 3
expect frame 3
)"),
            "");
}

TEST_F(Replay, PlaysToTheEndAndStops) {
  EXPECT_EQ(play(R"(key Space
until 4
idle
expect playing no
expect frame 7
expect processed 8
)"),
            "");
}

TEST_F(Replay, ThePaletteGoesToAFrameAndRunsActions) {
  EXPECT_EQ(play(R"(key Ctrl+Shift+P
wait 0.1
expect palette yes
text "5"
wait 0.1
key Enter
idle
expect palette no
expect frame 5
key Ctrl+Shift+P
wait 0.1
text "light or d"
wait 0.1
key Enter
wait 0.1
expect theme light
action toggle_theme
expect theme dark
key Shift+/
wait 0.1
expect shortcuts yes
key Esc
wait 0.1
expect shortcuts no
)"),
            "");
}

TEST_F(Replay, PanelsAreMaximisedHiddenAndBroughtBack) {
  EXPECT_EQ(
      play(R"(expect panels input,errors,timeline
point errors 0.5 0.05
key M
wait 0.1
expect maximised errors
key M
wait 0.1
expect maximised none
action panel.timeline
wait 0.1
expect panels input,errors
action panel.timeline
wait 0.1
expect panels~ timeline
size 700 500
size 1280 800
)",
           R"(layout {"columns": [{"panel": "input"}, {"rows": [{"panel": "errors"}, {"panel": "timeline"}]}]}
)"),
      "");
}

TEST_F(Replay, AClickInTheErrorsGoesThere) {
  EXPECT_EQ(play(R"(frame 7
action panel.errors
wait 0.1
expect panels~ errors
point errors 0.5 0.5
click left
idle
expect status tracked
)",
                 "layout {\"panel\": \"input\"}\n"),
            "");
}

TEST_F(Replay, ThePlotsOfErrorsAreZoomedAndMoved) {
  EXPECT_EQ(play(R"(frame 7
point timeline 0.5 0.1
wait 0.1
screenshot whole.png
point errors 0.6 0.75
wheel 0 4
point timeline 0.5 0.1
wait 0.1
screenshot nearer.png
point errors 0.6 0.75
press right
point errors 0.55 0.75
point errors 0.5 0.75
release right
point timeline 0.5 0.1
wait 0.1
expect frame 7
screenshot beside.png
point errors 0.6 0.75
click left
click left
idle
action last
idle
point timeline 0.5 0.1
wait 0.1
screenshot again.png
)",
                 R"(layout {"rows": [{"panel": "errors", "share": 0.7}, {"panel": "timeline", "share": 0.3}]}
)"),
            "");
  const auto shown = [&](const char* name) {
    const cv::Mat image = cv::imread(out_.path(name));
    return image.empty() ? image : cv::Mat(image(cv::Rect(20, 100, image.cols - 40, image.rows / 2)));
  };
  const cv::Mat whole = shown("whole.png"), nearer = shown("nearer.png"), beside = shown("beside.png");
  ASSERT_FALSE(whole.empty());
  EXPECT_FALSE(images_agree(nearer, whole, {2, 500.0, 0.0}));
  EXPECT_FALSE(images_agree(beside, nearer, {2, 500.0, 0.0}));
  EXPECT_TRUE(images_agree(shown("again.png"), whole, {2, 20.0, 0.0}));
}

TEST_F(Replay, ChoicesInALayoutAreTaken) {
  EXPECT_EQ(play(R"(frame 5
expect choices errors: Log scale=on
)",
                 R"(layout {"panel": "errors", "choices": {"Log scale": "on"}}
)"),
            "");
}

TEST_F(Replay, WhatIsNoSequenceIsSaidAndTheOneOpenStays) {
  EXPECT_EQ(play("drop " + out_.path() + R"(
idle
expect title sequence
expect frames 8
expect message~ stillpoint_
expect log.errors 1
drop /nowhere/at/all
idle
expect message~ /nowhere/at/all
expect log.errors 2
drop /nowhere/at/all
idle
expect log.errors 2
key Right
idle
expect frame 2
)"),
            "");
}

TEST_F(Replay, AFolderDroppedOnTheStartPageOpens) {
  opens_ = false;
  EXPECT_EQ(play("expect title none\ndrop " + folder_.path() + "\nidle\nexpect frames 8\nexpect frame 1\n"),
            "");
}

TEST_F(Replay, TwoReplaysGiveTheSameScreenshots) {
  for (const char* name : {"a.png", "b.png"})
    EXPECT_EQ(play("frame 5\npoint trajectory 0.5 0.5\nwheel 0 3\nwait 0.3\nscreenshot " + std::string(name) +
                   "\n"),
              "");
  const cv::Mat a = cv::imread(out_.path("a.png")), b = cv::imread(out_.path("b.png"));
  ASSERT_EQ(a.size(), cv::Size(1280, 800));
  EXPECT_FALSE(is_blank(a, 50));
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0.0);
}

TEST_F(Replay, SaysInWhichLineWhatDidNotHold) {
  EXPECT_EQ(play("expect frame 6\n"), "recording.txt:3: expected frame '6', found '1'");
  EXPECT_THAT(play("expect mood good\n"), HasSubstr(":3: there is no fact 'mood'; there are frame,"));
  EXPECT_THAT(play("action fly\n"), HasSubstr(":3: there is no action 'fly'"));
  EXPECT_THAT(play("action next_lost\n"), HasSubstr(":3: the action 'next_lost' is not possible now"));
  EXPECT_THAT(play("point log 0 0\n"), HasSubstr(":3: the panel 'log' is not shown"));
  EXPECT_THAT(play("frame 8\n"), HasSubstr(":3: there is no frame 8; the sequence has frames 0 to 7"));
  EXPECT_THAT(play("screenshot ../a.png\n"), HasSubstr("expected a screenshot's name"));
}

TEST_F(Replay, OfAnotherSequenceIsRefused) {
  const auto source = open_sequence(folder_.path());
  const auto complaint = [&](const std::string& line) -> std::string {
    try {
      require_same_sequence(parse_recording("stillpoint recording 1\n" + line, "a.txt"), *source);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(complaint("sequence 8 " + source->name() + "\n"), "");
  EXPECT_EQ(complaint(""), "");
  EXPECT_THAT(complaint("sequence 9 " + source->name() + "\n"), HasSubstr("a.txt:2: was recorded of"));
  EXPECT_THAT(complaint("sequence 8 another\n"), HasSubstr("'another' with 8 frames"));
}

}  // namespace
}  // namespace stillpoint::testing
