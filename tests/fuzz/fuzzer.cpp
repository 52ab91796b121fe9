// What libFuzzer calls. `stillpoint_fuzz --target=NAME FLAGS… CORPUS` feeds one target; `--list` names all,
// `--seeds=FOLDER` writes a target's valid miniatures there. One line at the end says what came of it.
#include <fmt/format.h>
#include <sanitizer/allocator_interface.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "core/media/media_module.hpp"
#include "core/stopwatch.hpp"
#include "tests/fuzz/targets.hpp"

namespace stillpoint::fuzz {
namespace {

const Target* target = nullptr;

// Bytes held beyond those at an input's start. The hooks run wherever memory is asked for, whatever else
// does.
std::atomic<long> held{0}, most_held{0};

void on_malloc(const volatile void*, std::size_t size) {
  const long now = held += static_cast<long>(size);
  long most = most_held;
  while (now > most && !most_held.compare_exchange_weak(most, now)) {
  }
}
void on_free(const volatile void* block) { held -= static_cast<long>(__sanitizer_get_allocated_size(block)); }

struct Figures {
  long inputs = 0, accepted = 0;
  double slowest_ms = 0.0;
  std::size_t slowest_size = 0;
  double nearest = 0.0;  // to the bound, as a share of it
  long nearest_held = 0;
  std::size_t nearest_size = 0;
} figures;

void tell() {
  fmt::print(
      "{}: {} inputs ({} valid), slowest {:.1f} ms (of {} bytes), most held {:.2f} MB (of {} bytes) = {:.0f} "
      "% of the bound\n",
      target->name, figures.inputs, figures.accepted, figures.slowest_ms, figures.slowest_size,
      static_cast<double>(figures.nearest_held) / 1e6, figures.nearest_size, 100.0 * figures.nearest);
}

void write_seeds(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const std::string& seed : target->seeds())
    std::ofstream(folder / fmt::format("seed_{:02}", number++), std::ios::binary) << seed;
}

const Target* find(std::string_view name) {
  for (const Target& one : targets())
    if (one.name == name) return &one;
  fmt::print(stderr, "stillpoint_fuzz: there is no target {}\n", name);
  std::exit(2);
}

}  // namespace
}  // namespace stillpoint::fuzz

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  using namespace stillpoint::fuzz;
  for (int i = 1; i < *argc; ++i) {
    const std::string_view argument = (*argv)[i];
    if (argument == "--list") {
      for (const Target& one : targets()) fmt::print("{}\n", one.name);
      std::exit(0);
    }
    constexpr std::string_view kTarget = "--target=", kSeeds = "--seeds=";
    if (argument.starts_with(kTarget)) target = find(argument.substr(kTarget.size()));
    if (argument.starts_with(kSeeds) && target != nullptr) {
      write_seeds(argument.substr(kSeeds.size()));
      std::exit(0);
    }
  }
  if (target == nullptr) {
    fmt::print(stderr, "stillpoint_fuzz: --target=NAME must say which; --list names them\n");
    std::exit(2);
  }
  // What is made or loaded once is no input's.
  (void)stillpoint::media_module();
  for (const std::string& seed : target->seeds()) (void)accepts(*target, seed);
  std::atexit(tell);
  __sanitizer_install_malloc_and_free_hooks(on_malloc, on_free);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  using namespace stillpoint::fuzz;
  held = 0, most_held = 0;
  const stillpoint::Stopwatch watch;
  figures.accepted += accepts(*target, {reinterpret_cast<const char*>(data), size}) ? 1 : 0;
  const double ms = watch.milliseconds();
  const long most = most_held;
  ++figures.inputs;
  if (ms > figures.slowest_ms) figures.slowest_ms = ms, figures.slowest_size = size;
  const double share = static_cast<double>(most) / static_cast<double>(target->bound.of(size));
  if (share > figures.nearest)
    figures.nearest = share, figures.nearest_held = most, figures.nearest_size = size;
  if (share > 1.0) {
    fmt::print(stderr, "{}: {} bytes held for an input of {}, more than the bound of {}\n", target->name,
               most, size, target->bound.of(size));
    std::abort();
  }
  return 0;
}
