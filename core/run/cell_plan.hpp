#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/benchmark_results.hpp"

namespace stillpoint {

// A benchmark or an ablation taken apart: a plan with one row a cell, which is one run; a record a cell,
// which whoever ran it left in the shared folder; and all of them merged in the plan's order, whoever ran
// them when. The folder holds `plan.json`, and `cells/` with NUMBER.json (the record) and NUMBER.log of each
// cell.

inline constexpr const char* kPlanName = "plan.json";

/// One run of a plan.
struct PlanCell {
  std::string sequence;          ///< a PlannedSequence's name
  std::string odometry, method;  ///< by their names
  int repeat = 0;                ///< perturbation (repeats.hpp); 0 = as it is
  std::string without{};         ///< an ingredient's name; empty = the whole method
  int frames = 0;                ///< so many the run has
  bool operator==(const PlanCell&) const = default;
};

/// "walking_xyz (features, paper, repeat 2)".
[[nodiscard]] std::string to_text(const PlanCell& cell);

/// A sequence of a plan, and how it is read.
struct PlannedSequence {
  std::string name;                  ///< by which cells know it; no two have the same
  std::string where;                 ///< an absolute path, or generated:KIND
  std::string runs;                  ///< folder of its runs, from the plan's; empty where they are not kept
  std::vector<std::string> reading;  ///< "depth_scale=1000", … (SequenceArguments::words)
  bool operator==(const PlannedSequence&) const = default;
};

/// What a cell reached.
struct CellResult {
  PlanCell cell;
  std::string json;  ///< whatever the plan's kind keeps of a run, one line
};

/// What is to be run, and by which program.
struct CellPlan {
  std::string kind;                           ///< the command it is of: benchmark, ablate
  std::string version, commit;                ///< of the program
  std::string command;                        ///< what was typed
  std::string config;                         ///< TOML, but for what a row says
  std::vector<std::string> engines, methods;  ///< columns of the tables
  bool repeated = false;                      ///< each was asked for several times
  bool replaces = false;  ///< earlier results are in the folder, and stay until every cell has ended
  std::vector<PlannedSequence> sequences;
  std::vector<CellResult> known;  ///< reached before: cells that are not run again, and runs of others
  std::vector<PlanCell> cells;

  /// @throws InputError where the plan has none of that name
  [[nodiscard]] const PlannedSequence& sequence(const std::string& name) const;
  /// Of everything that decides what a cell's result is and which number it has, 16 hex digits.
  [[nodiscard]] std::string fingerprint() const;
};

[[nodiscard]] std::string to_json_text(const CellPlan& plan);
/// @param where names the text in messages: a file's name
/// @throws InputError where it is no plan
[[nodiscard]] CellPlan plan_from_json(const std::string& text, const std::string& where);

/// @throws InputError where the folder holds no plan
[[nodiscard]] CellPlan read_plan(const std::filesystem::path& folder);
/// Writes the plan, and takes away records and logs where they are of another one.
/// @throws InputError when it cannot be written
void write_plan(const std::filesystem::path& folder, const CellPlan& plan);
/// Takes away the plan and its records; logs stay.
void remove_plan(const std::filesystem::path& folder);

/// How a cell ended.
struct CellRecord {
  int cell = 0;         ///< its row in the plan, from 0
  std::string plan;     ///< CellPlan::fingerprint
  std::string commit;   ///< of the program that ran it
  std::string machine;  ///< that it ran on
  int status = 0;       ///< exit status; 128 + signal where one ended it
  std::string said{};   ///< the last line of its log, where it failed
  std::string json{};   ///< CellResult::json, where it did not
};

[[nodiscard]] std::string to_json_text(const CellRecord& record);
/// @throws InputError where it is no record
[[nodiscard]] CellRecord record_from_json(const std::string& text, const std::string& where);

/// Of the cell's log, from the plan's folder.
[[nodiscard]] std::string cell_log_name(int cell);
/// Of its record.
[[nodiscard]] std::string cell_record_name(int cell);

/// Writes a record, whole or not at all, also where another process writes the same one.
/// @throws InputError when it cannot be written
void write_record(const std::filesystem::path& folder, const CellRecord& record);

/// What is known of a plan's cells.
struct CellRecords {
  std::vector<std::optional<CellRecord>> of_cell;  ///< by number; nothing where a cell has not ended
  std::vector<bool> begun;                         ///< by number: it has a log
};

/// All there are.
/// @throws InputError where one is of another plan or another build
[[nodiscard]] CellRecords read_records(const std::filesystem::path& folder, const CellPlan& plan);

/// One cell's; nothing where it has not ended.
/// @throws InputError likewise
[[nodiscard]] std::optional<CellRecord> read_record(const std::filesystem::path& folder, const CellPlan& plan,
                                                    const std::string& fingerprint, int cell);

/// Numbers of the cells that have no result: not begun, not ended, or failed.
[[nodiscard]] std::vector<int> missing_cells(const CellPlan& plan, const CellRecords& records);

/// A plan's cells put together.
struct MergedCells {
  std::vector<CellResult> results;    ///< what is known and none of the plan's, then the plan's in its order
  std::vector<MissingRun> missing;    ///< cells without a result, in the plan's order
  std::vector<std::string> machines;  ///< that cells ran on, each once, in the order of the cells
  bool whole = false;                 ///< every cell has ended, well or not
};

[[nodiscard]] MergedCells merge_cells(const CellPlan& plan, const CellRecords& records);

/// @throws InputError where a plan was made by another build than `commit`, with what follows
void throw_if_other_build(const CellPlan& plan, const std::string& commit, const std::string& folder);

}  // namespace stillpoint
