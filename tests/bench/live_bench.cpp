// What a live session costs as it grows: `live_bench SEQUENCE [METHOD [FRAMES]]` shows one frame after the
// other as the window does while it plays, and prints the processor time a frame by tenths of the way. Run by
// hand.
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <opencv2/core.hpp>
#include <string>
#include <thread>

#include "core/sequence/source.hpp"
#include "tests/bench/bench_main.hpp"
#include "tests/support/resident_memory.hpp"
#include "ui/session/session.hpp"

namespace {

using namespace stillpoint;

double processor_ms() { return 1000.0 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void measure(const std::string& where, const std::string& method, int frames) {
  const std::shared_ptr<const FrameSource> source = open_sequence(where);
  Config config;
  config.run.method = method;
  const int count = frames > 0 ? std::min(frames, source->size()) : source->size();
  fmt::print("{}, {} of {} frames, method {}\n", source->name(), count, source->size(), method);
  Session session(source, config);
  session.start();
  session.request_speed(1000.0);
  session.request_frame(0);
  session.request_play(true);
  constexpr int kParts = 10;
  double before = processor_ms();
  for (int part = 1; part <= kParts; ++part) {
    const int from = (part - 1) * count / kParts, to = part * count / kParts;
    while (session.view()->processed < to) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    const double now = processor_ms();
    fmt::print("frames {:6} to {:6}: {:6.2f} ms of processor time a frame, {:.0f} MB resident\n", from,
               to - 1, (now - before) / std::max(1, to - from), resident_mb());
    std::fflush(stdout);
    before = now;
  }
}

}  // namespace

int main(int argc, char** argv) { return stillpoint::method_bench_main(argc, argv, "live_bench", measure); }
