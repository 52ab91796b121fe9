// What a window keeps one waiting for: `window_bench SEQUENCE [FRAMES]` opens a sequence in a window of the
// display that DISPLAY names, processes it, then steps through it by keys and plays it. Run by hand, by
// tests/bench/pace.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/stopwatch.hpp"
#include "tests/bench/bench_main.hpp"
#include "ui/shell/window.hpp"
#include "ui/workbench/app_controller.hpp"

namespace {

using namespace stillpoint;

constexpr int kSteps = 60;
constexpr double kPlayedSeconds = 5.0;

void tell(const std::string& what, std::vector<double> ms) {
  if (ms.empty()) return;
  std::sort(ms.begin(), ms.end());
  fmt::print("{:<44} median {:6.1f} ms, 95 % {:6.1f} ms, worst {:6.1f} ms\n", what, ms[ms.size() / 2],
             ms[ms.size() * 95 / 100], ms.back());
}

class Bench {
 public:
  Bench(const std::string& where, int frames)
      : controller_({.open_source =
                         [](const std::string& place, const Config& config, const std::vector<std::string>&) {
                           return opened(open_sequence(place), config);
                         },
                     .config = method("stillpoint"),
                     .settings = {},
                     .marks_folder = {},
                     .plays_when_opened = {},
                     .wake = [] { Window::wake(); }}) {
    OpenOptions options;
    options.frames = frames;
    controller_.show(opened(open_sequence(where, options), method("stillpoint")), where);
    draw_until([this] { return view() != nullptr && controller_.workbench().is_level(); });
    tell("first picture, from main()", {since_start_.milliseconds()});
    draw_until([this] { return controller_.idle(); });
    controller_.session()->request_frame(view()->frame_count - 1);
    draw_until([this] { return controller_.idle() && view()->processed == view()->frame_count; });
  }

  void step() {
    std::mt19937 random(1);
    std::vector<double> forward, back, whole;
    for (int i = 0; i < kSteps; ++i) {
      const bool ahead = i % 2 == 0;
      const int from = 1 + static_cast<int>(random() % static_cast<unsigned>(view()->frame_count - 2));
      controller_.session()->request_frame(from);
      draw_until([&] { return controller_.idle() && view()->current->index == from; });
      const Stopwatch watch;
      for (const bool down : {true, false})
        window_.send(KeyChanged{ahead ? Key::kRight : Key::kLeft, down, {}});
      draw_until([&] { return view()->current->index == from + (ahead ? 1 : -1) && changed_; });
      (ahead ? forward : back).push_back(watch.milliseconds());
      draw_until([&] { return controller_.workbench().is_level(); });
      whole.push_back(watch.milliseconds());
    }
    tell("key to the first pixel, a frame on", forward);
    tell("key to the first pixel, a frame back", back);
    tell("… to the last tile, either way", whole);
  }

  void play() {
    controller_.session()->request_frame(0);
    draw_until([&] { return controller_.idle() && view()->current->index == 0; });
    controller_.session()->request_play(true);
    const Stopwatch watch;
    std::set<int> shown;
    std::vector<double> frames_ms;
    draw_until([&] {
      shown.insert(view()->current->index);
      if (drawn_ms_ > 0) frames_ms.push_back(drawn_ms_);
      return watch.milliseconds() > 1000.0 * kPlayedSeconds;
    });
    controller_.session()->request_play(false);
    fmt::print("{:<44} {:.1f} frames a second of 30\n", "played, processed before",
               static_cast<double>(shown.size()) / kPlayedSeconds);
    tell("… frames of the interface meanwhile", frames_ms);
  }

 private:
  static OpenedSource opened(std::shared_ptr<const FrameSource> source, const Config& config) {
    OpenedSource place;
    place.source = std::move(source);
    place.config = config;
    return place;
  }
  static Config method(const std::string& name) {
    Config config;
    config.run.method = name;
    return config;
  }
  [[nodiscard]] std::shared_ptr<const SessionView> view() const { return controller_.view(); }

  /// As Window::run() does.
  void draw_until(const std::function<bool()>& holds) {
    for (;;) {
      const Stopwatch watch;
      const UiFrame frame = window_.draw([this](UiFrame& ui) { controller_.draw(ui); });
      drawn_ms_ = watch.milliseconds();
      changed_ = frame.changed;
      if (holds()) return;
      if (window_.canvas().has_pending_input()) continue;
      glfwWaitEventsTimeout(std::min(std::max(frame.redraw_after_s, 0.001), 0.25));
    }
  }

  Stopwatch since_start_;
  Window window_;
  AppController controller_;
  bool changed_ = false;
  double drawn_ms_ = 0.0;
};

}  // namespace

int main(int argc, char** argv) {
  return stillpoint::bench_main(argc, argv, "window_bench SEQUENCE [FRAMES]",
                                [](const std::vector<std::string>& words) {
                                  Bench bench(words[0], words.size() > 1 ? std::stoi(words[1]) : 0);
                                  bench.step();
                                  bench.play();
                                });
}
