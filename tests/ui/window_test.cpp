#include "ui/shell/window.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <thread>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "core/error.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/xvfb.hpp"
#include "tests/ui/gallery.hpp"
#include "ui/shell/offscreen.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kWindowWidth = 1200, kWindowHeight = 800;

class WindowTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!xvfb_.running()) GTEST_SKIP() << "Xvfb is not installed";
  }

 private:
  Xvfb xvfb_;
};

/// Draws until the window has the size it was asked for and ImGui has settled.
cv::Mat settled_image(Window& window, const FrameFunction& function) {
  window.draw(function);
  // An X server's pointer stands in the middle of the screen, an image's nowhere.
  window.send(MouseMoved{-1e5F, -1e5F});
  for (int i = 0; i < 4; ++i) window.draw(function);
  return window.capture(function);
}

TEST_F(WindowTest, ShowsWhatTheOffscreenImageHolds) {
  cv::Mat shown;
  {
    Window window({.width = kWindowWidth, .height = kWindowHeight});
    Gallery gallery(false);
    shown = settled_image(window, std::ref(gallery));
    EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
  }
  Offscreen offscreen({.width = kWindowWidth, .height = kWindowHeight});
  Gallery gallery(false);
  EXPECT_TRUE(images_agree(shown, offscreen.render(std::ref(gallery)), kInterfaceTolerance));
}

TEST_F(WindowTest, ShowsTheTrajectoryAsTheOffscreenImageDoes) {
  cv::Mat shown;
  {
    Window window({.width = kWindowWidth, .height = kWindowHeight});
    Gallery gallery(true);
    shown = settled_image(window, std::ref(gallery));
    EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
  }
  Offscreen offscreen({.width = kWindowWidth, .height = kWindowHeight});
  Gallery gallery(true);
  EXPECT_TRUE(images_agree(shown, offscreen.render(std::ref(gallery)), kSceneTolerance));
}

TEST_F(WindowTest, LivesBesideOffscreenContexts) {
  const FrameFunction hello = [](UiFrame&) {
    ImGui::GetForegroundDrawList()->AddRectFilled({20, 20}, {120, 90}, IM_COL32(255, 128, 0, 255));
    ImGui::GetForegroundDrawList()->AddText({150, 40}, IM_COL32(255, 255, 255, 255), "hello");
  };
  Window window({.width = 400, .height = 300});
  const cv::Mat alone = settled_image(window, hello);
  for (const OffscreenBackend backend : {OffscreenBackend::kOsMesa, OffscreenBackend::kEgl}) {
    Offscreen lasting({.width = 400, .height = 300, .backend = backend});
    for (int i = 0; i < 3; ++i) {
      Offscreen passing({.width = 400, .height = 300, .backend = backend});
      EXPECT_TRUE(images_agree(window.capture(hello), alone, kInterfaceTolerance));
      EXPECT_TRUE(images_agree(passing.render(hello), alone, kInterfaceTolerance));
      EXPECT_TRUE(images_agree(lasting.render(hello), alone, kInterfaceTolerance));
      EXPECT_THAT(lasting.take_gl_errors(), IsEmpty());
    }
  }
  EXPECT_TRUE(images_agree(window.capture(hello), alone, kInterfaceTolerance));
  EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
}

TEST_F(WindowTest, TakesTheMouseFromTheDisplay) {
  Window window({.width = 400, .height = 300});
  ImVec2 mouse{};
  const FrameFunction function = [&](UiFrame&) { mouse = ImGui::GetIO().MousePos; };
  window.draw(function);
  glfwSetCursorPos(window.handle(), 123.0, 77.0);
  for (int i = 0; i < 50 && mouse.x != 123.0F; ++i) {
    window.draw(function);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  EXPECT_EQ(mouse.x, 123.0F);
  EXPECT_EQ(mouse.y, 77.0F);
}

TEST_F(WindowTest, WhatTheMouseWasOnIsLeftWithTheWindow) {
  Window window({.width = 400, .height = 300});
  ImVec2 mouse{};
  bool tip = false;
  const FrameFunction function = [&](UiFrame&) {
    mouse = ImGui::GetIO().MousePos;
    ImGui::SetNextWindowPos({0, 0});
    ImGui::Begin("all", nullptr, ImGuiWindowFlags_NoDecoration);
    ImGui::Button("a button", {350, 250});
    tip = ImGui::IsItemHovered();
    if (tip) ImGui::SetTooltip("what it is for");
    ImGui::End();
  };
  const auto until = [&](const std::function<bool()>& holds) {
    for (int i = 0; i < 200 && !holds(); ++i) {
      window.draw(function);
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return holds();
  };
  window.draw(function);
  glfwSetCursorPos(window.handle(), 123.0, 77.0);
  ASSERT_TRUE(until([&] { return mouse.x == 123.0F && tip; }));
  glfwSetCursorPos(window.handle(), 430.0, 320.0);
  EXPECT_TRUE(until([&] { return !tip && mouse.x < -1000.0F; }));
}

TEST_F(WindowTest, RunsUntilToldToQuitAndSleepsBetween) {
  Window window({.width = 400, .height = 300});
  int frames = 0;
  std::vector<std::string> dropped;
  std::thread waker;
  window.run([&](UiFrame& frame) {
    ++frames;
    dropped.insert(dropped.end(), frame.dropped_files.begin(), frame.dropped_files.end());
    if (frames == 1) {
      window.send(FilesDropped{{"some/folder"}});
      waker = std::thread([] {
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        Window::wake();
      });
    }
    // Only a wake or the display's own events bring frames after the first ones have settled.
    if (frame.time_s > 0.25) frame.quit = true;
  });
  waker.join();
  EXPECT_LT(frames, 15);
  EXPECT_THAT(dropped, ElementsAre("some/folder"));
}

TEST_F(WindowTest, ClosingIsAskedNotDone) {
  Window window({.width = 300, .height = 200});
  int asked = 0;
  window.draw([](UiFrame& frame) { EXPECT_FALSE(frame.close_requested); });
  glfwSetWindowShouldClose(window.handle(), GLFW_TRUE);
  window.run([&](UiFrame& frame) {
    if (frame.close_requested) frame.quit = ++asked == 1;
  });
  EXPECT_EQ(asked, 1);
}

TEST_F(WindowTest, SurvivesAStormOfSizes) {
  Window window({.width = 640, .height = 480});
  Gallery gallery(true);
  for (int i = 0; i < 40; ++i) {
    window.resize(60 + (i * 397) % 1500, 40 + (i * 211) % 1000);
    window.draw(std::ref(gallery));
  }
  EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
}

TEST_F(WindowTest, CopiesAndPastes) {
  Window window({.width = 300, .height = 200});
  window.draw([](UiFrame&) { ImGui::SetClipboardText("0.0169 m"); });
  window.draw([](UiFrame&) { EXPECT_STREQ(ImGui::GetClipboardText(), "0.0169 m"); });
}

/// What opening a window complains of.
std::string complaint() {
  try {
    const Window window({.width = 300, .height = 200});
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(WindowSizes, GrowWithTheDisplaysLettersAndFitTheScreen) {
  using Size = std::array<int, 2>;
  EXPECT_EQ(opening_size({}, 1.0F, {0, 0}), (Size{1600, 900}));
  EXPECT_EQ(opening_size({}, 2.0F, {3840, 2130}), (Size{3200, 1800}));
  EXPECT_EQ(opening_size({}, 2.0F, {2560, 1400}), (Size{2560, 1400}));
  // A size that was left by a person is what it was.
  EXPECT_EQ(opening_size({.width = 1234, .height = 777, .grows_with_display = false}, 2.0F, {3840, 2130}),
            (Size{1234, 777}));
}

TEST(WindowWithoutDisplayTest, NamesSnapshot) {
  const char* display = std::getenv("DISPLAY");
  const std::string before = display == nullptr ? "" : display;
  ::unsetenv("DISPLAY");
  ::unsetenv("WAYLAND_DISPLAY");
  EXPECT_THAT(complaint(), HasSubstr("stillpoint snapshot"));
  EXPECT_THAT(complaint(), HasSubstr("no window can be opened"));
  if (!before.empty()) ::setenv("DISPLAY", before.c_str(), 1);
}

TEST(WindowWithoutDisplayTest, SaysWhenThereIsNoOpenGl) {
  const Xvfb without_gl({"-extension", "GLX"});
  if (!without_gl.running()) GTEST_SKIP() << "Xvfb is not installed";
  EXPECT_THAT(complaint(), HasSubstr("no OpenGL 3.3"));
}

}  // namespace
}  // namespace stillpoint::testing
