// How long a sequence takes to show its first frame, and how many frames a second are read, of several kinds
// in one sitting: `reading_bench --write FOLDER OUT` packs a folder in every way, `reading_bench PLACE…`
// measures, the first place being what the others are compared with.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <opencv2/core/utility.hpp>
#include <string>
#include <vector>

#include "core/sequence/prefetch.hpp"
#include "core/sequence/source.hpp"
#include "core/stopwatch.hpp"
#include "tests/support/archive_writer.hpp"
#include "tests/unit/bag_example.hpp"

namespace stillpoint {
namespace {

constexpr int kRounds = 3;

void write_all(const std::string& folder, const std::string& out) {
  std::filesystem::create_directories(out);
  const std::string name = std::filesystem::path(folder).filename().string();
  for (const auto& [kind, ending] :
       {std::pair("tar", ".tar"), {"tgz", ".tgz"}, {"tar.bz2", ".tar.bz2"}, {"zip", ".zip"}})
    write_archive(out + "/" + name + ending, folder, kind, name);
  write_archive(out + "/" + name + "_stored.zip", folder, "zip_stored", name);
  const auto source = open_sequence(folder);
  BagExample ros2;
  ros2.cdr = true;
  const auto one = messages_of(*source), two = messages_of(*source, ros2);
  for (const char* compression : {"none", "lz4", "bz2"})
    write_ros1_bag(fmt::format("{}/{}_{}.bag", out, name, compression), one, compression);
  for (const char* compression : {"", "lz4", "zstd"})
    write_mcap(fmt::format("{}/{}_{}.mcap", out, name, compression), two, compression);
  write_db3(fmt::format("{}/{}.db3", out, name), two);
}

struct Measured {
  double first_ms = 0, frames_per_s = 0;
};

Measured measure(const std::string& where) {
  Measured measured;
  const Stopwatch opening;
  const auto source = open_sequence(where);
  (void)source->read(0);
  measured.first_ms = opening.milliseconds();
  const Stopwatch reading;
  Prefetcher frames(*source, 0, -1, 1, 4);
  while (frames.has_next()) (void)frames.next();
  measured.frames_per_s = 1000.0 * source->size() / reading.milliseconds();
  return measured;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

void measure_all(const std::vector<std::string>& places) {
  std::vector<std::vector<double>> first(places.size()), rate(places.size());
  // By turns, so that what the machine does meanwhile meets all alike.
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Measured measured = measure(places[i]);
      first[i].push_back(measured.first_ms), rate[i].push_back(measured.frames_per_s);
    }
  for (std::size_t i = 0; i < places.size(); ++i)
    fmt::print(
        "{:<40} first opening {:7.0f} ms, later {:6.0f} ms, {:6.1f} frames/s, {:5.2f} of the first's\n",
        std::filesystem::path(places[i]).filename().string(), first[i].front(),
        *std::min_element(first[i].begin(), first[i].end()), median(rate[i]),
        median(rate[i]) / median(rate[0]));
}

}  // namespace
}  // namespace stillpoint

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  if (argc == 4 && std::strcmp(argv[1], "--write") == 0)
    stillpoint::write_all(argv[2], argv[3]);
  else
    stillpoint::measure_all({argv + 1, argv + argc});
  return 0;
}
