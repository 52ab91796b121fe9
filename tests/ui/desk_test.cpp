// The whole program but its command line: sequences opened and left in a real window under Xvfb, and
// offscreen.
#include "ui/workbench/desk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <future>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "core/error.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/xvfb.hpp"
#include "ui/workbench/replay.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kWidth = 1000, kHeight = 700, kDemoFrames = 10, kFrames = 8;

/// Without times, which differ from run to run.
OpenedPlace untimed(std::shared_ptr<const FrameSource> source, const Config& config) {
  OpenedPlace place{.source = std::move(source), .config = config, .options = {}, .problem = {}};
  place.options.keep_times = false;
  return place;
}

DeskOptions desk_options() {
  Config config;
  config.run.method = "stillpoint";
  return {.open_place =
              [](const std::string& where, const Config& wanted) {
                OpenOptions options;
                options.frames = where.starts_with("generated:") ? kDemoFrames : 0;
                return untimed(open_sequence(where, options), wanted);
              },
          .config = config,
          .settings = {},
          .marks_folder = {},
          .plays_when_opened = "generated:walking_static",
          .wake = {}};
}

/// Draws until `holds()`, for half a minute at the most.
template <typename Draw, typename Condition>
bool draw_until(Draw draw, Condition holds) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(300);
  while (!holds() && std::chrono::steady_clock::now() < end) {
    draw();
    std::this_thread::sleep_for(std::chrono::milliseconds(3));
  }
  return holds();
}

class DeskInAWindow : public ::testing::Test {
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

TEST_F(DeskInAWindow, PlaysTheDemoTakesKeysMouseAndADrop) {
  Window window({.width = kWidth, .height = kHeight, .gl_debug = true});
  const DisplayEvents display(window.handle());
  Desk desk(desk_options());
  const auto draw = [&] { window.draw([&](UiFrame& frame) { desk.draw(frame); }); };
  const auto shown = [&] { return desk.view() ? desk.view()->current->index : -1; };
  desk.open("generated:walking_static");
  EXPECT_TRUE(draw_until(draw, [&] { return desk.idle() && shown() == kDemoFrames - 1; }));
  display.strike(GLFW_KEY_HOME);
  EXPECT_TRUE(draw_until(draw, [&] { return desk.idle() && shown() == 0; }));
  display.strike(GLFW_KEY_RIGHT);
  EXPECT_TRUE(draw_until(draw, [&] { return desk.idle() && shown() == 1; }));

  // A click in the timeline goes to a frame; where it lies the workbench knows.
  const auto tile = desk.workbench().tile_of("timeline");
  ASSERT_TRUE(tile);
  glfwSetCursorPos(window.handle(), static_cast<double>(tile->x + 0.6F * tile->width),
                   static_cast<double>(tile->y + 0.6F * tile->height));
  EXPECT_TRUE(draw_until(draw, [&] { return ImGui::GetIO().MousePos.x > tile->x; }));
  draw();
  display.click(GLFW_MOUSE_BUTTON_LEFT);
  EXPECT_TRUE(draw_until(draw, [&] { return desk.idle() && shown() > 1; }));
  display.scroll(1.0);
  draw();

  display.drop(folder_.path());
  EXPECT_TRUE(draw_until(draw, [&] { return desk.idle() && desk.view()->frame_count == kFrames; }));
  EXPECT_THAT(desk.title(), HasSubstr(" - Stillpoint"));
  EXPECT_FALSE(is_blank(window.capture([&](UiFrame& frame) { desk.draw(frame); }), 50));
  EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
  EXPECT_GT(window.canvas().pace().busy_frames, 0);
}

TEST_F(DeskInAWindow, ShowsWhatTheOffscreenImageHolds) {
  const Recording recording = parse_recording(
      "stillpoint recording 1\nidle\nframe 5\npoint union_mask 0.5 0.5\nwheel 0 2\nwait 0.1\nmove -100000 "
      "-100000\n"
      "screenshot shown.png\n",
      "r.txt");
  const auto image_of = [&](auto& shell, const TemporaryFolder& out) {
    {
      Desk desk(desk_options());
      desk.workbench().set_layout(default_layout("paper"));
      desk.open(folder_.path());
      replay(recording, desk, replay_shell(shell), {.out = out.path(), .patience_s = 60.0, .between = [] {}});
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

TEST_F(DeskInAWindow, SurvivesAStormOfSizesWhilePlaying) {
  Window window({.width = 640, .height = 480, .gl_debug = true});
  Desk desk(desk_options());
  desk.open(folder_.path());
  const auto draw = [&] { window.draw([&](UiFrame& frame) { desk.draw(frame); }); };
  EXPECT_TRUE(draw_until(draw, [&] { return desk.idle(); }));
  desk.session()->request_play(true);
  for (int i = 0; i < 40; ++i) {
    window.resize(60 + (i * 397) % 1500, 40 + (i * 211) % 1000);
    draw();
  }
  EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
  EXPECT_TRUE(draw_until(draw, [&] { return desk.idle(); }));
}

TEST_F(DeskInAWindow, ASequenceThatVanishesIsSaidAndTheWindowLivesOn) {
  Window window({.width = 640, .height = 480});
  Desk desk(desk_options());
  desk.open(folder_.path());
  const auto draw = [&] { window.draw([&](UiFrame& frame) { desk.draw(frame); }); };
  EXPECT_TRUE(draw_until(draw, [&] { return desk.idle() && desk.view(); }));
  std::filesystem::remove_all(folder_.path());
  desk.session()->request_frame(kFrames - 1);
  EXPECT_TRUE(draw_until(draw, [&] { return desk.idle() && desk.view()->processed == kFrames; }));
  EXPECT_EQ(desk.view()->current->record->status, FrameStatus::unreadable);
  EXPECT_NE(desk.view()->current->record->note, "");
  EXPECT_THAT(window.canvas().take_gl_errors(), IsEmpty());
}

// Without a display -----------------------------------------------------------------------------------------

/// A sequence made of nothing, which takes no time to open.
class TinySource final : public FrameSource {
 public:
  TinySource() {
    camera_.width = 64;
    camera_.height = 48;
    camera_.fx = camera_.fy = 50.0;
    camera_.cx = 31.5;
    camera_.cy = 23.5;
    image_ = cv::Mat(48, 64, CV_8UC3);
    cv::randu(image_, 0, 255);
  }
  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] const Camera& camera() const override { return camera_; }
  [[nodiscard]] int size() const override { return 3; }
  [[nodiscard]] double timestamp(int index) const override { return index / 30.0; }
  [[nodiscard]] Frame read(int index) const override {
    Frame frame;
    frame.index = index;
    frame.timestamp = timestamp(index);
    frame.colour = image_.clone();
    frame.gray = cv::Mat(48, 64, CV_8UC1, cv::Scalar(90));
    return frame;
  }
  [[nodiscard]] FrameTruth truth(int) const override { return {}; }
  [[nodiscard]] const Trajectory& ground_truth() const override { return truth_; }
  [[nodiscard]] bool has_depth() const override { return false; }
  [[nodiscard]] bool has_masks() const override { return false; }
  [[nodiscard]] const std::vector<std::string>& warnings() const override { return warnings_; }

 private:
  std::string name_ = "tiny";
  Camera camera_;
  cv::Mat image_;
  Trajectory truth_;
  std::vector<std::string> warnings_;
};

/// The name the next texture gets: GL gives the smallest that is free.
GLuint next_texture(const Gl& gl) {
  GLuint name = 0;
  gl.GenTextures(1, &name);
  gl.DeleteTextures(1, &name);
  return name;
}

double resident_mb() {
  std::ifstream file("/proc/self/statm");
  double whole = 0.0, resident = 0.0;
  file >> whole >> resident;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

TEST(Desk, AThousandSequencesLeaveNothingBehind) {
  Offscreen offscreen({.width = 200, .height = 150});
  DeskOptions options = desk_options();
  options.config.run.method = "none";
  options.open_place = [](const std::string&, const Config& config) {
    return untimed(std::make_shared<const TinySource>(), config);
  };
  {
    Desk desk(std::move(options));
    desk.workbench().set_layout({.panel = "input"});
    const auto open = [&](int times) {
      for (int i = 0; i < times; ++i) {
        desk.open("tiny");
        while (!desk.idle()) offscreen.draw([&](UiFrame& frame) { desk.draw(frame); });
        ASSERT_TRUE(desk.view());
      }
      offscreen.draw([&](UiFrame& frame) { desk.draw(frame); });
    };
    open(100);
    const GLuint texture = next_texture(offscreen.gl());
    const double before = resident_mb();
    open(900);
    EXPECT_LE(next_texture(offscreen.gl()), texture + 1);
    EXPECT_LT(resident_mb() - before, 15.0);
    EXPECT_EQ(desk.settings().recent, std::vector<std::string>{"tiny"});
    offscreen.make_current();
  }
  EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
}

TEST(Desk, ShellsLeaveNothingBehind) {
  const auto open = [](int times) {
    for (int i = 0; i < times; ++i) {
      Offscreen offscreen({.width = 100, .height = 80});
      offscreen.draw([](UiFrame&) {});
    }
  };
  open(4);
  const double before = resident_mb();
  open(20);
  EXPECT_LT(resident_mb() - before, 20.0);
}

TEST(Desk, WhatIsOpenedMeanwhileRunsWithTheConfigThatWasChosen) {
  const SmallSequence folder(4);
  Offscreen offscreen({.width = 500, .height = 400});
  std::promise<void> gate;
  const std::shared_future<void> opened(gate.get_future());
  DeskOptions options = desk_options();
  options.config.run.method = "none";
  options.open_place = [opened, &folder](const std::string& where, const Config& config) {
    if (where == "slow") opened.wait();
    return untimed(open_sequence(folder.path()), config);
  };
  {
    Desk desk(std::move(options));
    desk.workbench().set_layout({.panel = "removal"});
    const auto draw = [&] { offscreen.draw([&](UiFrame& frame) { desk.draw(frame); }); };
    desk.open("first");
    EXPECT_TRUE(draw_until(draw, [&] { return desk.idle() && desk.view(); }));
    draw();
    desk.open("slow");
    // The panel's button runs all anew with the check: it is found by pressing down the panel's left side.
    const auto tile = desk.workbench().tile_of("removal");
    ASSERT_TRUE(tile);
    for (float y = tile->y; y < tile->y + tile->height && desk.config().run.check_removal == 0; y += 8.0F) {
      const std::vector<InputEvent> click{MouseMoved{tile->x + 40.0F, y}, MouseButton{0, true, {}},
                                          MouseButton{0, false, {}}};
      for (const InputEvent& event : click) {
        offscreen.send(event);
        draw();
      }
      draw();
    }
    ASSERT_EQ(desk.config().run.check_removal, 1);
    const Session* first = desk.session();
    gate.set_value();
    EXPECT_TRUE(draw_until(draw, [&] { return desk.idle() && desk.session() != first; }));
    EXPECT_EQ(desk.view()->config.run.check_removal, 1);
    EXPECT_EQ(desk.view()->config.run.method, "none");
    offscreen.make_current();
  }
  EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
}

TEST(Desk, OpensBesideTheInterface) {
  Offscreen offscreen({.width = 400, .height = 300});
  std::promise<void> gate;
  const std::shared_future<void> opened(gate.get_future());
  DeskOptions options = desk_options();
  options.open_place = [opened](const std::string& where, const Config& config) {
    if (where == "bad") throw InputError("bad: is no sequence.");
    opened.wait();
    return untimed(std::make_shared<const TinySource>(), config);
  };
  {
    Desk desk(std::move(options));
    const FrameFunction draw = [&](UiFrame& frame) { desk.draw(frame); };
    desk.open("slow");
    // It would wait here for ever if it opened by itself.
    const UiFrame frame = offscreen.draw(draw);
    EXPECT_TRUE(frame.busy);
    EXPECT_LT(frame.redraw_after_s, 1.0);
    EXPECT_FALSE(desk.idle());
    EXPECT_FALSE(desk.view());
    gate.set_value();
    EXPECT_TRUE(draw_until([&] { offscreen.draw(draw); }, [&] { return desk.idle() && desk.view(); }));
    desk.open("bad");
    EXPECT_TRUE(draw_until([&] { offscreen.draw(draw); }, [&] { return desk.idle(); }));
    EXPECT_EQ(desk.workbench().message(), "bad: is no sequence.");
    EXPECT_EQ(desk.workbench().log().errors(), 1);
    EXPECT_TRUE(desk.view());
    offscreen.make_current();
  }
}

TEST(Desk, OfSeveralAskedForTheLastIsOpened) {
  Offscreen offscreen({.width = 400, .height = 300});
  std::vector<std::string> asked;
  std::mutex mutex;
  DeskOptions options = desk_options();
  options.open_place = [&](const std::string& where, const Config& config) {
    const std::lock_guard lock(mutex);
    asked.push_back(where);
    return untimed(std::make_shared<const TinySource>(), config);
  };
  {
    Desk desk(std::move(options));
    for (const char* where : {"a", "b", "c"}) desk.open(where);
    EXPECT_TRUE(draw_until([&] { offscreen.draw([&](UiFrame& frame) { desk.draw(frame); }); },
                           [&] { return desk.idle() && desk.view(); }));
    EXPECT_EQ(asked, (std::vector<std::string>{"a", "c"}));
    EXPECT_EQ(desk.settings().recent, std::vector<std::string>{"c"});
    offscreen.make_current();
  }
}

TEST(Settings, AFullDiskLeavesWhatWasThere) {
  const TemporaryFolder folder;
  const std::string path = folder.path("settings.json");
  Settings settings;
  settings.window_size = {800, 600};
  write_settings(path, settings);
  const std::string before = folder.read("settings.json");
  // As on a full disk: not a byte more may be written.
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit none{0, limit.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &none), 0);
  settings.window_size = {1234, 777};
  EXPECT_THROW(write_settings(path, settings), InputError);
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(folder.read("settings.json"), before);
  write_settings(path, settings);
  EXPECT_EQ(read_settings(path, {}).window_size, settings.window_size);
}

}  // namespace
}  // namespace stillpoint::testing
