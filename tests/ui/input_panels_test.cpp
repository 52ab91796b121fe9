// The panels in which a person questions the input and draws its truth, by mouse and key over the workbench.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/inspect/drawn_truth.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"
#include "tests/support/golden.hpp"
#include "tests/ui/panel_stage.hpp"
#include "tests/ui/session_example.hpp"
#include "ui/workbench/workbench.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int kRoomWidth = 900, kRoomHeight = 700;

class InputPanels : public ::testing::Test {
 protected:
  ~InputPanels() override {
    EXPECT_THAT(offscreen_.take_gl_errors(), IsEmpty());
    offscreen_.make_current();
  }
  void show(const std::string& panel) {
    LayoutNode only;
    only.panel = panel;
    LayoutNode root;
    root.children.push_back(only);
    workbench_.set_layout(root);
    draw();
  }
  void draw() {
    // What was asked for is in the session a frame later.
    for (int i = 0; i < 2; ++i)
      offscreen_.draw([this](UiFrame& frame) { workbench_.draw(frame, &session_); });
    for (SessionRequest& request : std::exchange(asked_, {})) {
      if (const auto* drawn = std::get_if<request::Drawn>(&request)) session_.debug.drawn = drawn->all;
      taken_.push_back(std::move(request));
    }
  }
  void press(float x, float y, bool down, int button = 0) {
    offscreen_.send(MouseMoved{x, y});
    draw();
    offscreen_.send(MouseButton{button, down, {}});
    draw();
  }
  void click(float x, float y, int button = 0) { press(x, y, true, button), press(x, y, false, button); }
  void drag(float x, float y, float to_x, float to_y) { press(x, y, true), press(to_x, to_y, false); }
  void strike(Key key) {
    for (const bool down : {true, false}) {
      offscreen_.send(KeyChanged{key, down, {}});
      draw();
    }
  }
  /// Runs a named action. @returns whether it was enabled
  bool perform(const std::string& action) {
    bool run = false;
    workbench_.before_next_frame([&] { run = workbench_.actions().run(action); });
    draw();
    return run;
  }
  [[nodiscard]] const std::vector<Outline>& movers() const {
    static const std::vector<Outline> none;
    const DrawnFrame* drawn = drawn_at(session_.debug.drawn, session_.current->index);
    return drawn != nullptr ? drawn->movers : none;
  }

  SessionView session_ = generated_example();
  std::vector<SessionRequest> asked_, taken_;
  std::vector<std::string> reopened_;
  Offscreen offscreen_{{.width = kRoomWidth, .height = kRoomHeight}};
  Workbench workbench_{make_panels(),
                       {.reopen = [this](const std::string& with) { reopened_.push_back(with); },
                        .request = [this](SessionRequest wish) { asked_.push_back(std::move(wish)); }}};
};

TEST_F(InputPanels, AnOutlineIsDrawnCornerByCornerAndClosed) {
  show("outline");
  click(300, 300), click(500, 300), click(500, 400);
  EXPECT_THAT(movers(), IsEmpty());  // not closed yet
  strike(Key::kEnter);
  ASSERT_EQ(movers().size(), 1U);
  ASSERT_EQ(movers()[0].size(), 3U);
  const Outline first = movers()[0];
  const double scale = (first[1].x - first[0].x) / 200.0;  // px of the image a px of the window
  EXPECT_GT(scale, 0.3);
  EXPECT_NEAR(first[1].y, first[0].y, 0.11);
  EXPECT_NEAR(first[2].y - first[1].y, 100.0 * scale, 0.25);

  click(250, 500), click(350, 500), click(350, 560), click(250, 500);  // the first corner closes it as well
  ASSERT_EQ(movers().size(), 2U);
  EXPECT_EQ(movers()[1].size(), 3U);
  EXPECT_EQ(movers()[0], first);
}

TEST_F(InputPanels, CornersAndEdgesAreDraggedAndTakenOut) {
  show("outline");
  click(300, 300), click(500, 300), click(500, 400);
  strike(Key::kEnter);
  const Outline before = movers().at(0);
  const double scale = (before[1].x - before[0].x) / 200.0;
  drag(500, 400, 520, 450);
  ASSERT_EQ(movers().at(0).size(), 3U);
  EXPECT_EQ(movers()[0][0], before[0]);
  EXPECT_NEAR(movers()[0][2].x - before[2].x, 20.0 * scale, 0.25);
  EXPECT_NEAR(movers()[0][2].y - before[2].y, 50.0 * scale, 0.25);
  drag(400, 300, 400, 250);  // an edge: a corner more
  ASSERT_EQ(movers()[0].size(), 4U);
  EXPECT_NEAR(movers()[0][1].y - before[0].y, -50.0 * scale, 0.25);
  click(400, 250, 1);
  EXPECT_EQ(movers()[0].size(), 3U);
  click(300, 300, 1);  // two corners are no outline
  EXPECT_THAT(movers(), IsEmpty());
  ASSERT_NE(drawn_at(session_.debug.drawn, session_.current->index),
            nullptr);  // and the frame is drawn: empty
}

TEST_F(InputPanels, BackspaceTakesTheLastCornerAndDeleteTheOutlineUnderTheMouse) {
  show("outline");
  click(300, 300), click(500, 300), click(500, 400), click(600, 450);
  strike(Key::kBackspace);
  strike(Key::kEnter);
  ASSERT_EQ(movers().size(), 1U);
  EXPECT_EQ(movers()[0].size(), 3U);
  offscreen_.send(MouseMoved{480, 330});
  draw();
  offscreen_.send(MouseMoved{480, 20});  // away from the picture: nothing is under the mouse
  draw();
  strike(Key::kDelete);
  EXPECT_EQ(movers().size(), 1U);
  offscreen_.send(MouseMoved{480, 330});
  draw();
  strike(Key::kDelete);
  EXPECT_THAT(movers(), IsEmpty());
}

TEST_F(InputPanels, AnOutlineBegunIsThereAgainWhenItsFrameIs) {
  show("outline");
  click(300, 300), click(500, 300), click(500, 400);
  const auto frame = session_.current;
  auto other = std::make_shared<FrameView>(*frame);
  other->index = frame->index - 1;
  session_.current = other;
  draw();
  strike(Key::kEnter);  // nothing was begun here
  EXPECT_THAT(session_.debug.drawn, IsEmpty());
  session_.current = frame;
  draw();
  strike(Key::kEnter);
  ASSERT_EQ(movers().size(), 1U);
  EXPECT_EQ(movers()[0].size(), 3U);
}

TEST_F(InputPanels, MasksAreOutlinesToBeginWithAndAreCarriedWhenAskedFor) {
  show("outline");
  ASSERT_TRUE(perform("outline_from_truth"));
  ASSERT_FALSE(movers().empty());
  const cv::Mat& truth = session_.current->truth.moving;
  EXPECT_GT(cv::countNonZero(mask_of_outlines(movers(), truth.size()) & truth),
            0.95 * cv::countNonZero(truth));
  ASSERT_TRUE(perform("outline_carry"));
  ASSERT_FALSE(taken_.empty());
  EXPECT_TRUE(std::holds_alternative<request::WriteTruth>(taken_.back()));
  ASSERT_TRUE(perform("outline_clear"));
  EXPECT_THAT(session_.debug.drawn, IsEmpty());
  EXPECT_FALSE(perform("outline_carry"));  // nothing to be carried
}

SessionView questioned() {
  SessionView session = handmade_example();
  session.debug.check.whole = true;
  session.debug.check.findings = {
      {"camera", "freiburg1 fits better than ros_default (`--camera freiburg1` uses it)"},
      {"images", "1 of 7 sampled colour images are the same, pixel for pixel, as the one before"}};
  session.debug.check.times = {"colour's readout 24.7 ± 0.3 ms (camera freiburg1: 25.0)"};
  return session;
}

TEST_F(InputPanels, AFindingThatASwitchMendsOpensTheSequenceAgainWithIt) {
  session_ = questioned();
  show("check");
  // Down the column of sentences, until something happens.
  for (float y = 150; y < 300 && reopened_.empty(); y += 6) click(180, y);
  EXPECT_THAT(reopened_, ElementsAre("camera=freiburg1"));
  ASSERT_TRUE(perform("check_input"));
  ASSERT_FALSE(taken_.empty());
  EXPECT_TRUE(std::holds_alternative<request::CheckSequence>(taken_.back()));
}

TEST(InputPanelPictures, GoldenImages) {
  PanelStage check("check", {ThemeName::kDark, 1.0F}, 520, 320);
  EXPECT_TRUE(matches_golden(check.render(questioned()), "input_check"));
  SessionView drawn = handmade_example();
  const int here = drawn.current->index;
  drawn.debug.drawn = {{2, {}}, {here, {{{20, 30}, {70, 25}, {75, 90}, {22, 95}}}}};
  PanelStage outline("outline", {ThemeName::kLight, 1.0F}, 640, 420);
  EXPECT_TRUE(matches_golden(outline.render(drawn), "input_outline"));
}

}  // namespace
}  // namespace stillpoint::testing
