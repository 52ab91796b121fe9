// The whole program but its command line, in a real window under Xvfb: sequences opened, played and left.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "ui/workbench/app_controller.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "tests/cli/small_sequence.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/xvfb.hpp"
#include "tests/ui/controller_example.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/shell/window.hpp"
#include "ui/workbench/replay.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kWidth = 1000, kHeight = 700, kFrames = 8;

class ControllerInAWindow : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!xvfb_.running()) GTEST_SKIP() << "Xvfb is not installed";
  }

  SmallSequence folder_{kFrames};

 private:
  Xvfb xvfb_;
};

/// The callbacks GLFW calls when the display tells of something: called here as GLFW would.
class DisplayEvents {
 public:
  explicit DisplayEvents(GLFWwindow* window)
      : window_(window),
        key_(glfwSetKeyCallback(window, nullptr)),
        button_(glfwSetMouseButtonCallback(window, nullptr)),
        scroll_(glfwSetScrollCallback(window, nullptr)),
        drop_(glfwSetDropCallback(window, nullptr)) {
    glfwSetKeyCallback(window, key_);
    glfwSetMouseButtonCallback(window, button_);
    glfwSetScrollCallback(window, scroll_);
    glfwSetDropCallback(window, drop_);
  }
  void strike(int key) const {
    key_(window_, key, 0, GLFW_PRESS, 0);
    key_(window_, key, 0, GLFW_RELEASE, 0);
  }
  void click(int button) const {
    button_(window_, button, GLFW_PRESS, 0);
    button_(window_, button, GLFW_RELEASE, 0);
  }
  void scroll(double notches) const { scroll_(window_, 0.0, notches); }
  void drop(const std::string& path) const {
    const char* paths[] = {path.c_str()};
    drop_(window_, 1, paths);
  }

 private:
  GLFWwindow* window_;
  GLFWkeyfun key_;
  GLFWmousebuttonfun button_;
  GLFWscrollfun scroll_;
  GLFWdropfun drop_;
};

TEST_F(ControllerInAWindow, PlaysTheDemoTakesKeysMouseAndADrop) {
  Window window({.width = kWidth, .height = kHeight, .gl_debug = true});
  const DisplayEvents display(window.handle());
  AppController controller(controller_options());
  const auto draw = [&] { window.draw([&](UiFrame& frame) { controller.draw(frame); }); };
  const auto shown = [&] { return controller.view() ? controller.view()->current->index : -1; };
  controller.open("generated:walking_static");
  EXPECT_TRUE(draw_until(draw, [&] { return controller.idle() && shown() == kDemoFrames - 1; }));
  display.strike(GLFW_KEY_HOME);
  EXPECT_TRUE(draw_until(draw, [&] { return controller.idle() && shown() == 0; }));
  display.strike(GLFW_KEY_RIGHT);
  EXPECT_TRUE(draw_until(draw, [&] { return controller.idle() && shown() == 1; }));

  // A click in the timeline goes to a frame; where it lies the workbench knows.
  const auto tile = controller.workbench().tile_of("timeline");
  ASSERT_TRUE(tile);
  glfwSetCursorPos(window.handle(), static_cast<double>(tile->x + 0.6F * tile->width),
                   static_cast<double>(tile->y + 0.6F * tile->height));
  EXPECT_TRUE(draw_until(draw, [&] { return ImGui::GetIO().MousePos.x > tile->x; }));
  draw();
  display.click(GLFW_MOUSE_BUTTON_LEFT);
  EXPECT_TRUE(draw_until(draw, [&] { return controller.idle() && shown() > 1; }));
  display.scroll(1.0);
  draw();

  display.drop(folder_.path());
  EXPECT_TRUE(
      draw_until(draw, [&] { return controller.idle() && controller.view()->frame_count == kFrames; }));
  EXPECT_THAT(controller.title(), HasSubstr(" - Stillpoint"));
  EXPECT_FALSE(is_blank(window.capture([&](UiFrame& frame) { controller.draw(frame); }), 50));
  EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
  EXPECT_GT(window.canvas().pace().busy_frames, 0);
}

TEST_F(ControllerInAWindow, ShowsWhatTheOffscreenImageHolds) {
  const Recording recording = parse_recording(
      "stillpoint recording 1\nidle\nframe 5\npoint features_before 0.5 0.5\nwheel 0 2\nwait 0.1\nmove -100000 "
      "-100000\n"
      "screenshot shown.png\n",
      "r.txt");
  const auto image_of = [&](auto& shell, const TemporaryFolder& out) {
    {
      AppController controller(controller_options());
      controller.workbench().set_layout(default_layout("paper"));
      controller.open(folder_.path());
      replay(recording, controller, replay_shell(shell),
             {.out = out.path(), .patience_s = 60.0, .between = [] {}});
    }
    return cv::imread(out.path("shown.png"));
  };
  const TemporaryFolder in_window, offscreen_folder;
  cv::Mat shown;
  {
    Window window({.width = kWidth, .height = kHeight, .gl_debug = true});
    shown = image_of(window, in_window);
    EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
  }
  Offscreen offscreen({.width = kWidth, .height = kHeight});
  const cv::Mat expected = image_of(offscreen, offscreen_folder);
  EXPECT_FALSE(is_blank(expected, 50));
  EXPECT_TRUE(images_agree(shown, expected, kSceneTolerance));
}

TEST_F(ControllerInAWindow, SurvivesAStormOfSizesWhilePlaying) {
  Window window({.width = 640, .height = 480, .gl_debug = true});
  AppController controller(controller_options());
  controller.open(folder_.path());
  const auto draw = [&] { window.draw([&](UiFrame& frame) { controller.draw(frame); }); };
  EXPECT_TRUE(draw_until(draw, [&] { return controller.idle(); }));
  controller.session()->request_play(true);
  for (int i = 0; i < 40; ++i) {
    window.resize(60 + (i * 397) % 1500, 40 + (i * 211) % 1000);
    draw();
  }
  EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
  EXPECT_TRUE(draw_until(draw, [&] { return controller.idle(); }));
}

TEST_F(ControllerInAWindow, ASequenceThatVanishesIsSaidAndTheWindowLivesOn) {
  Window window({.width = 640, .height = 480});
  AppController controller(controller_options());
  controller.open(folder_.path());
  const auto draw = [&] { window.draw([&](UiFrame& frame) { controller.draw(frame); }); };
  EXPECT_TRUE(draw_until(draw, [&] { return controller.idle() && controller.view(); }));
  std::filesystem::remove_all(folder_.path());
  controller.session()->request_frame(kFrames - 1);
  EXPECT_TRUE(draw_until(draw, [&] { return controller.idle() && controller.view()->processed == kFrames; }));
  EXPECT_EQ(controller.view()->current->record->status, FrameStatus::unreadable);
  EXPECT_NE(controller.view()->current->record->note, "");
  EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
}

}  // namespace
}  // namespace stillpoint::testing
