#include "ui/workbench/replay.hpp"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "core/error.hpp"
#include "core/inspect/run_view.hpp"
#include "core/media/image_codec.hpp"
#include "core/stopwatch.hpp"
#include "ui/shell/event_log.hpp"

namespace stillpoint {
namespace {

constexpr int kSettlingFrames = 4;  // frames, until what an input sets off is laid out and drawn
// So short that waiting is not seen, and work has the processor.
constexpr auto kNap = std::chrono::milliseconds(4);

/// A recording on its way.
class Player {
 public:
  Player(const Recording& recording, AppController& controller, const ReplayShell& shell,
         const ReplayOptions& options)
      : recording_(recording), controller_(controller), shell_(shell), options_(options) {}

  ReplayResult play() {
    // Events are written down when everything stands; so it is again before the first.
    settle(1);
    for (const RecordedLine& line : recording_.lines) {
      line_ = line.line;
      std::visit([this](const auto& one) { happen(one); }, line.what);
      ++result_.events;
      if (result_.quit) break;
    }
    return result_;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError(fmt::format("{}:{}: {}", recording_.file, line_, why));
  }

  void draw() {
    options_.between();
    result_.quit = shell_.draw([this](UiFrame& frame) { controller_.draw(frame); }).quit || result_.quit;
  }

  /// Draws until `holds()`, which may wait for work beside the interface.
  template <typename Condition>
  void draw_until(Condition holds, const char* what) {
    const Stopwatch watch;
    for (;;) {
      draw();
      if (result_.quit || holds()) return;
      if (watch.milliseconds() > 1000.0 * options_.patience_s)
        fail(fmt::format("{} within {:g} s", what, options_.patience_s));
      std::this_thread::sleep_for(kNap);
    }
  }

  void settle(int frames) {
    draw_until([this] { return controller_.idle(); }, "nothing came to rest");
    for (int i = 0; i < frames; ++i) draw();
  }

  void happen(const InputEvent& event) {
    shell_.canvas->send(event);
    while (shell_.canvas->has_pending_input() && !result_.quit) draw();
  }

  void happen(const event::Wait& wait) {
    const double end = shell_.canvas->time_s() + wait.seconds;
    while (shell_.canvas->time_s() < end && !result_.quit) draw();
  }

  void happen(const event::Idle&) { settle(kSettlingFrames); }

  void happen(const event::Until& until) {
    draw_until(
        [&] {
          const auto view = controller_.view();
          return !view || view->current->index >= until.frame || (controller_.idle() && !view->playing);
        },
        "the frame was not reached");
  }

  void happen(const event::Frame& wanted) {
    const auto view = controller_.view();
    if (!view) fail("there is no sequence to go to a frame of");
    if (wanted.frame >= view->frame_count)
      fail(fmt::format("there is no frame {}; the sequence has frames 0 to {}", wanted.frame,
                       view->frame_count - 1));
    if (view->current->index != wanted.frame) controller_.session()->request_frame(wanted.frame);
    settle(kSettlingFrames);
  }

  void happen(const event::Act& act) {
    const Actions& actions = controller_.workbench().actions();
    const Action* action = actions.find(act.name);
    if (action == nullptr) fail(fmt::format("there is no action '{}'", act.name));
    // Actions are run while a frame is drawn, as keys and buttons run them.
    options_.between();
    bool ran = false;
    controller_.workbench().before_next_frame([&ran, &actions, &act] { ran = actions.run(act.name); });
    draw();
    if (!ran) fail(fmt::format("the action '{}' is not possible now", act.name));
    draw();
  }

  void happen(const event::Point& point) {
    const auto tile = controller_.workbench().tile_of(point.panel);
    if (!tile) fail(fmt::format("the panel '{}' is not shown", point.panel));
    happen(InputEvent{MouseMoved{tile->x + static_cast<float>(point.x) * tile->width,
                                 tile->y + static_cast<float>(point.y) * tile->height}});
  }

  void happen(const event::Resize& size) {
    shell_.resize(size.width, size.height);
    for (int i = 0; i < kSettlingFrames; ++i) draw();
  }

  void happen(const event::Screenshot& screenshot) {
    if (screenshot.file.find('/') != std::string::npos || !screenshot.file.ends_with(".png"))
      fail(fmt::format("expected a screenshot's name like after.png, found '{}'", screenshot.file));
    settle(kSettlingFrames);
    const cv::Mat image = shell_.capture([this](UiFrame& frame) { controller_.draw(frame); });
    const std::filesystem::path path = options_.out / screenshot.file;
    bool written = false;
    try {
      written = save_image(path, image);
    } catch (const cv::Exception&) {
    }
    if (!written) fail(fmt::format("{} cannot be written", path.string()));
    ++result_.screenshots;
  }

  void happen(const event::Expect& expected) {
    draw();
    const auto view = controller_.view();
    const bool part = expected.what.ends_with("~");
    const std::string what = part ? expected.what.substr(0, expected.what.size() - 1) : expected.what;
    const auto found = controller_.workbench().fact(what, view.get());
    if (!found) fail(fmt::format("there is no fact '{}'; there are {}", what, Workbench::fact_names()));
    const bool holds = part ? found->find(expected.value) != std::string::npos : *found == expected.value;
    if (!holds)
      fail(fmt::format("expected {} {}'{}', found '{}'", what, part ? "to hold " : "", expected.value,
                       *found));
  }

  void happen(const event::Quit&) { result_.quit = true; }

  const Recording& recording_;
  AppController& controller_;
  const ReplayShell& shell_;
  const ReplayOptions& options_;
  int line_ = 1;
  ReplayResult result_;
};

}  // namespace

ReplayShell replay_shell(Window& window) {
  window.listen(false);
  return {&window.canvas(), [&window](const FrameFunction& function) { return window.draw(function); },
          [&window](const FrameFunction& function) { return window.capture(function); },
          [&window](int width, int height) { window.resize(width, height); }};
}

ReplayShell replay_shell(Offscreen& offscreen) {
  return {&offscreen.canvas(),
          [&offscreen](const FrameFunction& function) { return offscreen.draw(function); },
          [&offscreen](const FrameFunction& function) {
            offscreen.draw(function);
            return offscreen.image();
          },
          [&offscreen](int width, int height) { offscreen.resize(width, height); }};
}

void require_same_sequence(const Recording& recording, const FrameSource& source) {
  const RecordingStart& start = recording.start;
  const bool name = start.sequence_name.empty() || start.sequence_name == source.name();
  const bool frames = start.sequence_frames == 0 || start.sequence_frames == source.size();
  if (name && frames) return;
  throw InputError(fmt::format("{}:{}: was recorded of '{}' with {} frames; this is '{}' with {}",
                               recording.file, start.sequence_line, start.sequence_name,
                               start.sequence_frames, source.name(), source.size()));
}

ReplayResult replay(const Recording& recording, AppController& controller, const ReplayShell& shell,
                    const ReplayOptions& options) {
  return Player(recording, controller, shell, options).play();
}

}  // namespace stillpoint
