// What a session costs: `session_bench SEQUENCE [METHOD [FRAMES]]` processes a sequence as the window does,
// then goes to and fro in it, and prints times and prior. Run by hand, on a machine that does nothing else.
#include <fmt/format.h>
#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/motion/paper/paper_config.hpp"
#include "core/motion/stillpoint/stillpoint_config.hpp"
#include "core/run/run_report.hpp"
#include "core/stopwatch.hpp"
#include "tests/bench/bench_main.hpp"
#include "tests/support/resident_memory.hpp"
#include "ui/session/session.hpp"

namespace {

using namespace stillpoint;

void tell(const std::string& what, std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  fmt::print("{:<44} median {:6.1f} ms, 95 % {:6.1f} ms, worst {:6.1f} ms\n", what, ms[ms.size() / 2],
             ms[ms.size() * 95 / 100], ms.back());
}

/// What a person waits for while sliders move, from each request until it shows: at ten frames far apart the
/// motion stages of the first preview, of five later ones, and all that belongs to the last.
void measure_previews(Session& session, Config config, int count) {
  session.start();
  const auto shown_after = [&session](const std::function<bool(const DebugView&)>& is_there) {
    const Stopwatch watch;
    while (!is_there(session.view()->debug)) std::this_thread::sleep_for(std::chrono::microseconds(200));
    return watch.milliseconds();
  };
  std::mt19937 random(2);
  std::vector<double> first, later, whole;
  for (int i = 0; i < 10; ++i) {
    session.request(request::Preview{});
    const int frame = static_cast<int>(random() % static_cast<unsigned>(count));
    session.request_frame(frame);
    while (!session.idle() || session.view()->current->index != frame)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (int step = 0; step < 6; ++step) {
      config.of<PaperConfig>().ransac_threshold_px = 1.0 + 0.1 * step;
      config.of<StillpointConfig>().moving_log_odds = 0.2 + 0.01 * step;
      const auto before = session.view()->debug.preview;
      session.request(request::Preview{config});
      (step == 0 ? first : later).push_back(shown_after([&](const DebugView& debug) {
        return debug.preview != nullptr && debug.preview != before;
      }));
    }
    whole.push_back(shown_after([](const DebugView& debug) { return debug.preview_whole; }));
  }
  tell("preview, the first at a frame", first);
  tell("preview, later ones", later);
  tell("… its pose and matches after the last", whole);
}

void measure(const std::string& where, const std::string& method, int frames) {
  const std::shared_ptr<const FrameSource> source = open_sequence(where);
  Config config;
  config.run.method = method;
  const int count = frames > 0 ? std::min(frames, source->size()) : source->size();
  fmt::print("{}, {} of {} frames, method {}\n", source->name(), count, source->size(), method);

  Session session(source, config, {.baseline = false});
  const Stopwatch recorded;
  session.go_to(count - 1);
  const double recorded_ms = recorded.milliseconds() / count;
  malloc_trim(0);
  fmt::print("resident with all frames processed: {:.0f} MB\n", resident_mb());

  std::mt19937 random(1);
  std::vector<double> jumps, back;
  const auto timed_go = [&](int frame) {
    const Stopwatch watch;
    session.go_to(frame);
    return watch.milliseconds();
  };
  for (int i = 0; i < 60; ++i)
    jumps.push_back(timed_go(static_cast<int>(random() % static_cast<unsigned>(count))));
  tell("go to any frame", jumps);
  const int middle = count / 2;
  session.go_to(middle);
  for (int i = 1; i <= 40 && i <= middle; ++i) back.push_back(timed_go(middle - i));
  tell("one frame back", back);
  malloc_trim(0);
  fmt::print("resident: {:.0f} MB after going about\n", resident_mb());
  measure_previews(session, config, count);

  const Stopwatch batch;
  RunOptions options;
  options.count = count;
  const RunResult run = run_sequence(*source, config, options);
  const double batch_ms = batch.milliseconds() / count;
  fmt::print("a frame: batch {:.2f} ms, session {:.2f} ms ({:+.1f} %)\n", batch_ms, recorded_ms,
             100.0 * (recorded_ms / batch_ms - 1.0));
  fmt::print("hash: batch {}, session {}\n", run_hash(run.records), session.view()->debug.run_hash);
}

}  // namespace

int main(int argc, char** argv) {
  return stillpoint::method_bench_main(argc, argv, "session_bench", measure);
}
