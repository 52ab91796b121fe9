// The whole program but its command line, without a display: sequences opened and left.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <future>
#include <mutex>
#include <thread>

#include "core/error.hpp"
#include "tests/cli/small_sequence.hpp"
#include "tests/support/full_disk.hpp"
#include "tests/support/resident_memory.hpp"
#include "tests/ui/controller_example.hpp"
#include "ui/shell/offscreen.hpp"
#include "ui/workbench/app_controller.hpp"

namespace stillpoint::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

TEST(AppController, AThousandSequencesLeaveNothingBehind) {
  Offscreen offscreen({.width = 200, .height = 150});
  ControllerOptions options = controller_options();
  options.config.run.method = "none";
  options.open_source = [](const std::string&, const Config& config, const std::vector<std::string>&) {
    return untimed(std::make_shared<const TinySource>(), config);
  };
  {
    AppController controller(std::move(options));
    controller.workbench().set_layout({.panel = "input"});
    const auto open = [&](int times) {
      for (int i = 0; i < times; ++i) {
        controller.open("tiny");
        while (!controller.idle()) offscreen.draw([&](UiFrame& frame) { controller.draw(frame); });
        ASSERT_TRUE(controller.view());
      }
      offscreen.draw([&](UiFrame& frame) { controller.draw(frame); });
    };
    open(100);
    const GLuint texture = next_texture(offscreen.gl());
    const double before = resident_mb();
    open(900);
    EXPECT_LE(next_texture(offscreen.gl()), texture + 1);
    EXPECT_LT(resident_mb() - before, 15.0);
    ASSERT_EQ(controller.settings().recent.size(), 1U);
    EXPECT_EQ(controller.settings().recent[0].where, "tiny");
    offscreen.make_current();
  }
  EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
}

TEST(AppController, ShellsLeaveNothingBehind) {
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

TEST(AppController, WhatIsOpenedMeanwhileRunsWithTheConfigThatWasChosen) {
  const SmallSequence folder(4);
  Offscreen offscreen({.width = 500, .height = 400});
  std::promise<void> gate;
  const std::shared_future<void> opened(gate.get_future());
  ControllerOptions options = controller_options();
  options.config.run.method = "paper";
  options.open_source = [opened, &folder](const std::string& where, const Config& config,
                                          const std::vector<std::string>&) {
    if (where == "slow") opened.wait();
    return untimed(open_sequence(folder.path()), config);
  };
  {
    AppController controller(std::move(options));
    controller.workbench().set_layout({.panel = "removal"});
    const auto draw = [&] { offscreen.draw([&](UiFrame& frame) { controller.draw(frame); }); };
    controller.open("first");
    EXPECT_TRUE(draw_until(draw, [&] { return controller.idle() && controller.view(); }));
    draw();
    controller.open("slow");
    // The panel's button runs all anew with the check: it is found by pressing down the panel's left side.
    const auto tile = controller.workbench().tile_of("removal");
    ASSERT_TRUE(tile);
    for (float y = tile->y; y < tile->y + tile->height && controller.config().run.check_removal == 0;
         y += 8.0F) {
      const std::vector<InputEvent> click{MouseMoved{tile->x + 40.0F, y}, MouseButton{0, true, {}},
                                          MouseButton{0, false, {}}};
      for (const InputEvent& event : click) {
        offscreen.send(event);
        draw();
      }
      draw();
    }
    ASSERT_EQ(controller.config().run.check_removal, 1);
    const Session* first = controller.session();
    gate.set_value();
    EXPECT_TRUE(draw_until(draw, [&] { return controller.idle() && controller.session() != first; }));
    EXPECT_EQ(controller.view()->config.run.check_removal, 1);
    EXPECT_EQ(controller.view()->config.run.method, "paper");
    offscreen.make_current();
  }
  EXPECT_THAT(offscreen.take_gl_errors(), IsEmpty());
}

TEST(AppController, OpensBesideTheInterface) {
  Offscreen offscreen({.width = 400, .height = 300});
  std::promise<void> gate;
  const std::shared_future<void> opened(gate.get_future());
  ControllerOptions options = controller_options();
  options.open_source = [opened](const std::string& where, const Config& config,
                                 const std::vector<std::string>&) {
    if (where == "bad") throw InputError("bad: is no sequence.");
    opened.wait();
    return untimed(std::make_shared<const TinySource>(), config);
  };
  {
    AppController controller(std::move(options));
    const FrameFunction draw = [&](UiFrame& frame) { controller.draw(frame); };
    controller.open("slow");
    // It would wait here for ever if it opened by itself.
    const UiFrame frame = offscreen.draw(draw);
    EXPECT_TRUE(frame.busy);
    EXPECT_LT(frame.redraw_after_s, 1.0);
    EXPECT_FALSE(controller.idle());
    EXPECT_FALSE(controller.view());
    gate.set_value();
    EXPECT_TRUE(
        draw_until([&] { offscreen.draw(draw); }, [&] { return controller.idle() && controller.view(); }));
    controller.open("bad");
    EXPECT_TRUE(draw_until([&] { offscreen.draw(draw); }, [&] { return controller.idle(); }));
    EXPECT_EQ(controller.workbench().message(), "bad: is no sequence.");
    EXPECT_EQ(controller.workbench().log().errors(), 1);
    EXPECT_TRUE(controller.view());
    offscreen.make_current();
  }
}

TEST(AppController, OfSeveralAskedForTheLastIsOpened) {
  Offscreen offscreen({.width = 400, .height = 300});
  std::vector<std::string> asked;
  std::mutex mutex;
  ControllerOptions options = controller_options();
  options.open_source = [&](const std::string& where, const Config& config, const std::vector<std::string>&) {
    const std::lock_guard lock(mutex);
    asked.push_back(where);
    return untimed(std::make_shared<const TinySource>(), config);
  };
  {
    AppController controller(std::move(options));
    for (const char* where : {"a", "b", "c"}) controller.open(where);
    EXPECT_TRUE(draw_until([&] { offscreen.draw([&](UiFrame& frame) { controller.draw(frame); }); },
                           [&] { return controller.idle() && controller.view(); }));
    EXPECT_EQ(asked, (std::vector<std::string>{"a", "c"}));
    ASSERT_EQ(controller.settings().recent.size(), 1U);
    EXPECT_EQ(controller.settings().recent[0].where, "c");
    offscreen.make_current();
  }
}

/// What an experiment consists of comes back with its sequence: how it was read, its constants, its frame.
TEST(AppController, ASequenceComesBackAsItWasLeft) {
  Offscreen offscreen({.width = 400, .height = 300});
  std::mutex mutex;
  std::vector<std::string> read;
  std::string method;
  const auto options_with = [&](Settings settings) {
    ControllerOptions options = controller_options();
    options.settings = std::move(settings);
    options.open_source = [&](const std::string&, const Config& config,
                              const std::vector<std::string>& reading) {
      const std::lock_guard lock(mutex);
      read = reading, method = config.run.method;
      return untimed(std::make_shared<const TinySource>(), config);
    };
    return options;
  };
  const auto until_idle = [&](AppController& controller) {
    return draw_until([&] { offscreen.draw([&](UiFrame& frame) { controller.draw(frame); }); },
                      [&] { return controller.idle() && controller.view(); });
  };
  Settings left;
  {
    AppController controller(options_with({}));
    controller.show(untimed(std::make_shared<const TinySource>(), controller.config()), "first",
                    {"camera=freiburg2"});
    ASSERT_TRUE(until_idle(controller));
    Config other = controller.config();
    other.run.method = "paper";
    other.features.count = 777;
    controller.request(request::RunAll{other});
    ASSERT_TRUE(until_idle(controller));
    controller.session()->request_frame(2);
    ASSERT_TRUE(until_idle(controller));
    other.run.method = "none";
    controller.request(request::AddGhost{other, "without removal", 0});
    ASSERT_TRUE(until_idle(controller));
    controller.request(request::AddGhost{other, "from the third on", 2});
    ASSERT_TRUE(until_idle(controller));
    // The frame shown last lies before the one the ghost began at: the run goes there all the same.
    controller.session()->request_frame(1);
    ASSERT_TRUE(until_idle(controller));
    controller.open("second");
    ASSERT_TRUE(until_idle(controller));
    left = controller.settings();
    ASSERT_EQ(left.recent.size(), 2U);
    EXPECT_EQ(left.recent[1].where, "first");
    EXPECT_EQ(left.recent[1].reading, std::vector<std::string>{"camera=freiburg2"});
    EXPECT_EQ(left.recent[1].frame, 1);
    offscreen.make_current();
  }
  {
    AppController controller(options_with(left));
    controller.open("first");
    ASSERT_TRUE(until_idle(controller));
    EXPECT_EQ(read, std::vector<std::string>{"camera=freiburg2"});
    EXPECT_EQ(method, "paper");
    EXPECT_EQ(controller.config().features.count, 777);
    EXPECT_EQ(controller.view()->current->index, 1);
    ASSERT_EQ(controller.view()->debug.ghosts.size(), 2U);
    EXPECT_THAT(controller.view()->debug.waiting, ::testing::IsEmpty());
    EXPECT_EQ(controller.view()->debug.ghosts[1].name, "from the third on");
    EXPECT_EQ(controller.view()->debug.ghosts[1].from, 2);
    EXPECT_EQ(controller.view()->debug.ghosts[0].name, "without removal");
    EXPECT_EQ(controller.view()->debug.ghosts[0].config.run.method, "none");
    EXPECT_EQ(controller.view()->debug.ghosts[0].config.features.count, 777);
    offscreen.make_current();
  }
}

TEST(Settings, AFullDiskLeavesWhatWasThere) {
  const TemporaryFolder folder;
  const std::string path = folder.path("settings.json");
  Settings settings;
  settings.window_size = std::array<int, 2>{800, 600};
  write_settings(path, settings);
  const std::string before = folder.read("settings.json");
  settings.window_size = std::array<int, 2>{1234, 777};
  {
    const FullDisk full;
    EXPECT_THROW(write_settings(path, settings), InputError);
  }
  EXPECT_EQ(folder.read("settings.json"), before);
  write_settings(path, settings);
  EXPECT_EQ(read_settings(path, {}).window_size, settings.window_size);
}

}  // namespace
}  // namespace stillpoint::testing
