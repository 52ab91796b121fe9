#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/provenance.hpp"
#include "core/evaluation/tables.hpp"

namespace stillpoint {

// What a benchmark leaves (`results.json`): what it measured, run by run, and what it was made by. Tables are
// made of it, in the terminal and in pages (page_tables.hpp), so that no figure is written down twice.

/// What one run of a benchmark reached. A figure is absent where there is nothing to measure it by.
struct BenchmarkResult {
  std::string sequence, odometry, method;
  int repeat = 0;  ///< which of several runs, each a little perturbed; 0 = as it is
  int frames = 0;
  double coverage = 1.0;                     ///< share of frames with a pose, 0 to 1
  std::optional<double> ate_m;               ///< m, RMSE
  std::optional<double> rpe_m, rpe_deg;      ///< over 1 s, RMSE in m and degrees
  std::optional<double> rpe_frame_m;         ///< m, over one frame, RMSE
  int pairs = 0;                             ///< the RPE over 1 s is of
  std::optional<double> precision, recall;   ///< of the mask, 0 to 1, by pixels of all frames
  std::optional<double> iou;                 ///< likewise
  std::optional<double> partial_recall;      ///< of the part of the mask that the method names (partial_mask)
  std::optional<std::int64_t> right, wrong;  ///< features removed that are on what is dynamic, and not
  double median_ms = 0.0, p99_ms = 0.0;      ///< wall time of tracking a frame
  double units = 0.0;                        ///< median_ms in units of one ORB extraction; 0 = not measured
  std::string hash;                          ///< run_hash
  std::string why_no_rpe{};                  ///< of the RPE over 1 s; empty where there is one
  std::string doubt{};                       ///< RunReport::doubt
  bool operator==(const BenchmarkResult&) const = default;
};

/// A run that was asked for and has no result.
struct MissingRun {
  std::string sequence, odometry, method;
  int repeat = 0;
  std::string without{};  ///< an ingredient's name; empty = the whole method
  std::optional<int>
      status{};        ///< exit status, 128 + signal where one ended it; nothing where it has not ended
  std::string log{};   ///< from the results' folder; empty where it has not begun
  std::string said{};  ///< the last line of it
  bool operator==(const MissingRun&) const = default;
};

/// In place of an engine's name, for another program's run: it stands beside the runs behind any engine.
inline constexpr const char* kItsOwnOdometry = "its own";

/// A benchmark's results.
struct BenchmarkResults : Provenance {
  std::string config;  ///< TOML, but for method and odometry
  std::vector<BenchmarkResult> runs;
  std::vector<MissingRun> missing{};  ///< where runs were made as jobs: those that failed or have not ended

  /// Null where there is none. Another program's run is found behind any engine.
  [[nodiscard]] const BenchmarkResult* find(const std::string& sequence, const std::string& odometry,
                                            const std::string& method, int repeat = 0) const;
  /// In the order in which they first appear.
  [[nodiscard]] std::vector<std::string> sequences() const;
};

/// How every file of results begins.
[[nodiscard]] nlohmann::ordered_json to_json(const Provenance& made);
/// @throws InputError where the text does not begin so
[[nodiscard]] Provenance provenance_from_json(const std::string& text, const std::string& where);

[[nodiscard]] nlohmann::ordered_json to_json(const BenchmarkResults& results);

/// One run's object in it.
[[nodiscard]] nlohmann::ordered_json to_json(const BenchmarkResult& result);
[[nodiscard]] nlohmann::ordered_json to_json(const MissingRun& run);
/// @throws InputError where the text is none
[[nodiscard]] BenchmarkResult result_from_json(const std::string& text, const std::string& where);

/// @param where names the text in messages: a file's name
/// @throws InputError where it holds no results of a benchmark
[[nodiscard]] BenchmarkResults results_from_json(const std::string& text, const std::string& where);

/// Reads a `results.json`.
/// @throws InputError where it cannot be read or holds no results
[[nodiscard]] BenchmarkResults read_results(const std::string& path);

/// Table 1 of what one engine reached behind `methods` (table_one).
[[nodiscard]] Table table_one(const BenchmarkResults& results, const std::string& odometry,
                              const std::vector<std::string>& methods, const std::string& baseline);

/// What Table 1 leaves out: a row a run with its other errors, coverage, masks and speed.
[[nodiscard]] Table details_table(const BenchmarkResults& results);
/// What the columns of details_table hold, and what a dash in them means.
[[nodiscard]] std::string details_legend();

/// What is to be known beside these figures.
[[nodiscard]] std::vector<RunNote> notes_on(const BenchmarkResults& results);

/// "exit status 1", "exit status 139 (signal 11)".
[[nodiscard]] std::string exit_text(int status);

/// The same, "has not ended", "has not begun".
[[nodiscard]] std::string why_missing(const MissingRun& run);

/// A sentence with how many of `asked` runs have no result, and a row for each of the first of them: why, its
/// log and what it said last. Empty where none is missing.
[[nodiscard]] std::string missing_text(const std::vector<MissingRun>& missing, std::size_t asked);

}  // namespace stillpoint
