#include "app/version.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "core/version.hpp"
#include "stillpoint_commit.hpp"

namespace stillpoint {
namespace {

/// "Name of the processor, 2 cores".
std::string machine() {
  std::ifstream file("/proc/cpuinfo");
  std::string processor = "unknown processor";
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name"))
      if (const auto at = line.find(": "); at != std::string::npos) {
        processor = line.substr(at + 2);
        break;
      }
  return fmt::format("{}, {} cores", processor, std::thread::hardware_concurrency());
}

/// The program's arguments as they could be typed again, without the place it lies in.
std::string command_line() {
  std::ifstream file("/proc/self/cmdline", std::ios::binary);
  const std::string all((std::istreambuf_iterator<char>(file)), {});
  std::string text;
  for (std::size_t at = 0; at < all.size();) {
    std::string word = all.substr(at, all.find('\0', at) - at);
    at += word.size() + 1;
    if (text.empty()) word = std::filesystem::path(word).filename().string();
    const bool plain = !word.empty() && word.find_first_of(" '\"\\$&|;<>()*?#~`") == std::string::npos;
    text += (text.empty() ? "" : " ") + (plain ? word : "'" + word + "'");
  }
  return text;
}

}  // namespace

std::string version_text() {
  return fmt::format("stillpoint {} (commit {})", STILLPOINT_VERSION, STILLPOINT_COMMIT);
}

BenchmarkResults made_here() {
  BenchmarkResults results;
  results.version = STILLPOINT_VERSION;
  results.commit = STILLPOINT_COMMIT;
  results.machine = machine();
  results.date = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
  results.command = command_line();
  return results;
}

}  // namespace stillpoint
