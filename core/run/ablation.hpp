#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/config.hpp"
#include "core/evaluation/benchmark_results.hpp"
#include "core/evaluation/tables.hpp"
#include "core/motion/methods.hpp"

namespace stillpoint {

struct RunReport;

// What each ingredient of a method, and of the odometry behind it, is worth: the whole, and the method with
// one ingredient left out at a time, over the same sequences.

/// A method's own ingredients and then the odometry's, in the order of tables.
[[nodiscard]] std::vector<Ingredient> ingredients(const MethodInfo& method);

/// The ingredient of that name.
/// @throws InputError naming those there are
[[nodiscard]] Ingredient ingredient_by_name(const MethodInfo& method, const std::string& name);

/// `config` without one ingredient or, where `without` is null, whole.
[[nodiscard]] Config ablated(Config config, const Ingredient* without);

/// What one variant reached on one sequence.
struct AblationCell {
  std::optional<double> rpe_m;     ///< translational RPE over 1 s, RMSE, m
  std::optional<double> mask_iou;  ///< 0 to 1; nothing where no mask is known or nothing moves
  double coverage = 0.0;           ///< share of frames with a pose
  double median_ms = 0.0;          ///< tracking time a frame
  std::string hash;  ///< of the run's frames: equal to the whole method's where leaving out changed none
  std::optional<double> ate_m{};        ///< RMSE, m
  std::optional<double> rpe_frame_m{};  ///< translational RPE over one frame, RMSE, m
  std::size_t pairs = 0;                ///< poses 1 s apart that rpe_m is the error of
  std::string why_no_rpe{};             ///< of the RPE over 1 s; empty where there is one
  std::string doubt{};                  ///< RunReport::doubt
};

[[nodiscard]] AblationCell ablation_cell(const RunReport& report);

/// As ablation_json has it, but for the sequence.
[[nodiscard]] nlohmann::ordered_json to_json(const AblationCell& cell);
/// @throws InputError where the text is none
[[nodiscard]] AblationCell ablation_cell_from_json(const std::string& text, const std::string& where);

/// All that one variant reached, a cell a sequence, in their order.
struct AblationRow {
  std::string without;                     ///< an ingredient's name; empty = the whole method
  std::vector<std::string> assignments{};  ///< what left it out
  std::vector<AblationCell> cells;
};

/// What leaving something out did to the error over all sequences.
struct AblationChange {
  std::optional<double> mean;   ///< geometric mean of RPE over the whole method's, less 1; nothing = no pair
  std::optional<double> worst;  ///< the largest of these changes …
  std::size_t worst_sequence = 0;  ///< … and where
  std::optional<double> mask_iou;  ///< mean difference of IoU
  double median_ms = 0.0;          ///< mean over the sequences of the median time a frame
  double coverage = 1.0;           ///< least over the sequences
  int unchanged = 0;               ///< sequences on which nothing at all changed
};

/// @param row,whole with as many cells as one another; what one of them lacks is not compared
[[nodiscard]] AblationChange change_of(const AblationRow& row, const AblationRow& whole);

/// A row a variant, the whole method first: what changed over all sequences.
[[nodiscard]] Table ablation_summary(const std::string& method, const std::vector<AblationRow>& rows,
                                     const std::vector<std::string>& sequences);

/// A row a sequence: RPE over 1 s of each variant and of how many pairs it is, or over one frame where no run
/// lasts a second.
[[nodiscard]] Table ablation_errors(const std::vector<AblationRow>& rows,
                                    const std::vector<std::string>& sequences);

/// What is to be known beside these figures.
[[nodiscard]] std::vector<RunNote> notes_on(const std::vector<AblationRow>& rows,
                                            const std::vector<std::string>& sequences);

/// A row a run, for programs.
[[nodiscard]] Table ablation_list(const std::vector<AblationRow>& rows,
                                  const std::vector<std::string>& sequences);
[[nodiscard]] nlohmann::ordered_json ablation_json(const std::string& method,
                                                   const std::vector<AblationRow>& rows,
                                                   const std::vector<std::string>& sequences,
                                                   const Provenance& made);

/// An ablation read back.
struct Ablation {
  std::string method;
  std::vector<std::string> sequences;
  std::vector<AblationRow> rows;  ///< the whole method first

  [[nodiscard]] Table summary() const { return ablation_summary(method, rows, sequences); }
};

/// @throws InputError where the file holds none
[[nodiscard]] Ablation read_ablation(const std::string& path);

}  // namespace stillpoint
