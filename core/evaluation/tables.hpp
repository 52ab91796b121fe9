#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stillpoint {

/// What a cell holds where there is nothing to tell.
inline constexpr const char* kNoFigure = "–";

/// A run in which a smaller share of the frames has a pose counts as lost.
inline constexpr double kLostCoverage = 0.5;

/// A table of texts; every row has as many cells as the header.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// GitHub-flavoured Markdown, columns padded so that it reads as plain text too; the first column is aligned
/// left, the others right.
[[nodiscard]] std::string to_markdown(const Table& table);

/// One line of what to_csv() writes, its end included.
[[nodiscard]] std::string csv_line(const std::vector<std::string>& cells);

/// CSV after RFC 4180 with LF line ends.
[[nodiscard]] std::string to_csv(const Table& table);

/// What is to be known beside a run's figures.
struct RunNote {
  std::string run;         ///< which: sequence and method, or a value
  std::string why_no_rpe;  ///< why it has no RPE over 1 s; empty where it has one
  std::string doubt;       ///< why its figures are to be doubted (RunReport::doubt); empty mostly
};

/// For below a table, as a list: each reason for which there is no RPE, with its runs, and a doubt a run, as
/// many as fit a screen. Empty where there is nothing to say.
[[nodiscard]] std::string notes_text(const std::vector<RunNote>& notes);

/// A row of the paper's Table 1 (Niu & Li 2019): translational RPE, RMSE in m, by inference over 1 s.
struct PublishedRow {
  std::string sequence;         ///< short name, such as fr3_walking_xyz
  double orb_slam2_vo = 0.0;    ///< m
  double paper = 0.0;           ///< m
  std::optional<double> ref7;   ///< m, Gao 2019, block variance; nothing = lost
  std::optional<double> ref12;  ///< m, BaMVO
};

/// The nine rows, in the paper's order.
[[nodiscard]] const std::vector<PublishedRow>& published_table();

/// The published row a sequence is to be set beside, told by its name alone: `fr3_walking_xyz`,
/// `rgbd_dataset_freiburg3_walking_xyz`, `generated:walking_xyz` and `walking_xyz` are all the last one's.
[[nodiscard]] std::optional<PublishedRow> published_row(std::string_view sequence);

/// What one method reached on one sequence.
struct BenchmarkCell {
  std::string method;           ///< as in run.method
  std::optional<double> rpe_m;  ///< translational RPE over 1 s, RMSE in m; nothing = no pair to measure
  double coverage = 1.0;        ///< share of frames with a pose, 0 to 1
  int pairs = 0;                ///< the RPE is over
  bool outside = false;         ///< another program made it
};

/// What all methods reached on one sequence.
struct BenchmarkRow {
  std::string sequence;
  std::vector<BenchmarkCell> cells;
};

/// What is to be known of the published columns of these sequences, a line each; empty where they have none.
[[nodiscard]] std::string published_notes(const std::vector<std::string>& sequences);

/// The paper's Table 1 with our columns beside the published ones: sequence, ORB-SLAM2 VO, paper, Gao
/// 2019 and BaMVO as it quotes them, the published gain, then each of `methods` and, for each but `baseline`,
/// its gain over it. A gain is the share by which the error fell. A cell tells its coverage where that is
/// below 1. The last row is the mean of the gains, as the paper averages; it is of all rows that have the
/// figure.
[[nodiscard]] Table table_one(const std::vector<BenchmarkRow>& rows, const std::vector<std::string>& methods,
                              const std::string& baseline);

}  // namespace stillpoint
