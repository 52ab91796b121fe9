#include "core/evaluation/tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numeric>
#include <utility>

namespace stillpoint {
namespace {

/// Columns a text takes up: UTF-8 continuation bytes take none.
std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::string escaped_for_markdown(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

std::string metres(const std::optional<double>& value) {
  return value ? fmt::format("{:.6f}", *value) : std::string(kNoFigure);
}

std::string percent(const std::optional<double>& share) {
  if (!share) return kNoFigure;
  const std::string text = fmt::format("{:.1f} %", 100.0 * *share);
  return text == "-0.0 %" ? text.substr(1) : text;
}

std::string cell_text(const BenchmarkCell* cell) {
  if (cell == nullptr) return kNoFigure;
  // Lost is who has no pose to speak of; without ground truth, or over less than a second, there is just no
  // figure.
  if (!cell->rpe_m) return cell->coverage < kLostCoverage ? "lost" : kNoFigure;
  if (cell->coverage >= 1.0) return metres(cell->rpe_m);
  // Rounded down, so that a frame lost never reads as 100 %.
  return fmt::format("{} ({:.1f} % of frames)", metres(cell->rpe_m),
                     std::floor(1000.0 * cell->coverage) / 10.0);
}

const BenchmarkCell* find_cell(const BenchmarkRow& row, const std::string& method) {
  const auto it = std::find_if(row.cells.begin(), row.cells.end(),
                               [&](const BenchmarkCell& cell) { return cell.method == method; });
  return it == row.cells.end() ? nullptr : &*it;
}

std::optional<double> gain_over(const BenchmarkRow& row, const std::string& baseline,
                                const std::string& method) {
  const BenchmarkCell *base = find_cell(row, baseline), *other = find_cell(row, method);
  if (base == nullptr || other == nullptr || !base->rpe_m || !other->rpe_m || *base->rpe_m <= 0)
    return std::nullopt;
  return 1.0 - *other->rpe_m / *base->rpe_m;
}

/// Gains of one column, which are averaged in the last row.
struct GainColumn {
  std::vector<double> gains;
  std::string add(const std::optional<double>& gain) {
    if (gain) gains.push_back(*gain);
    return percent(gain);
  }
  [[nodiscard]] std::string mean() const {
    if (gains.empty()) return kNoFigure;
    return percent(std::accumulate(gains.begin(), gains.end(), 0.0) / static_cast<double>(gains.size()));
  }
};

}  // namespace

std::string to_markdown(const Table& table) {
  std::vector<std::size_t> widths(table.header.size(), 3);
  const auto measure = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      widths[i] = std::max(widths[i], width_of(escaped_for_markdown(cells[i])));
  };
  measure(table.header);
  for (const auto& row : table.rows) measure(row);

  std::string text;
  const auto line = [&](const std::vector<std::string>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string cell = escaped_for_markdown(cells[i]);
      const std::string padding(widths[i] - width_of(cell), ' ');
      text += i == 0 ? "| " + cell + padding : " | " + padding + cell;
    }
    text += " |\n";
  };
  line(table.header);
  for (std::size_t i = 0; i < widths.size(); ++i)
    text +=
        i == 0 ? fmt::format("|:{:-<{}}", "", widths[i] + 1) : fmt::format("|{:-<{}}:", "", widths[i] + 1);
  text += "|\n";
  for (const auto& row : table.rows) line(row);
  return text;
}

std::string csv_line(const std::vector<std::string>& cells) {
  std::string text;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::string cell = cells[i];
    if (cell.find_first_of(",\"\r\n") != std::string::npos) {
      for (auto at = cell.find('"'); at != std::string::npos; at = cell.find('"', at + 2))
        cell.insert(at, 1, '"');
      cell = "\"" + cell + "\"";
    }
    text += (i == 0 ? "" : ",") + cell;
  }
  return text + "\n";
}

std::string to_csv(const Table& table) {
  std::string text = csv_line(table.header);
  for (const auto& row : table.rows) text += csv_line(row);
  return text;
}

std::string notes_text(const std::vector<RunNote>& notes) {
  constexpr std::size_t kNamed = 4, kDoubts = 20;  // runs of one reason by name; lines
  std::vector<std::pair<std::string, std::vector<std::string>>> reasons;
  std::string doubts;
  std::size_t count = 0;
  for (const RunNote& note : notes) {
    if (!note.doubt.empty() && count++ < kDoubts) doubts += fmt::format("- {}: {}\n", note.run, note.doubt);
    if (note.why_no_rpe.empty()) continue;
    auto reason = std::find_if(reasons.begin(), reasons.end(),
                               [&note](const auto& known) { return known.first == note.why_no_rpe; });
    if (reason == reasons.end()) reason = reasons.insert(reason, {note.why_no_rpe, {}});
    reason->second.push_back(note.run);
  }
  if (count > kDoubts) doubts += fmt::format("- {} more runs are to be doubted\n", count - kDoubts);
  std::string text;
  for (const auto& [why, runs] : reasons)
    text += fmt::format("- no RPE over 1 s: {} ({})\n", why,
                        runs.size() > kNamed ? fmt::format("{} runs", runs.size())
                                             : fmt::format("{}", fmt::join(runs, "; ")));
  return text + doubts;
}

const std::vector<PublishedRow>& published_table() {
  static const std::vector<PublishedRow> rows = {
      {"fr2_desk_with_person", 0.028470, 0.006524, 0.009400, 0.035200},
      {"fr3_sitting_halfsphere", 0.022873, 0.022707, 0.026300, 0.058900},
      {"fr3_sitting_rpy", 0.027072, 0.025064, 0.022900, 0.187200},
      {"fr3_sitting_static", 0.012438, 0.010573, 0.008100, 0.015700},
      {"fr3_sitting_xyz", 0.011698, 0.011544, 0.013100, 0.048200},
      {"fr3_walking_halfsphere", 0.447234, 0.299790, 0.047600, 0.173800},
      {"fr3_walking_rpy", 0.912968, 0.612395, std::nullopt, 0.358400},
      {"fr3_walking_static", 0.463615, 0.056029, 0.010200, 0.133900},
      {"fr3_walking_xyz", 0.819595, 0.105852, 0.032000, 0.232600},
  };
  return rows;
}

std::optional<PublishedRow> published_row(std::string_view sequence) {
  std::string name(sequence);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const std::string_view prefix : {"generated:", "rgbd_dataset_"})
    if (name.starts_with(prefix)) name.erase(0, prefix.size());
  constexpr std::string_view kLong = "freiburg", kShort = "fr";
  if (const auto at = name.find(kLong); at != std::string::npos)
    name = name.substr(0, at).append(kShort).append(name, at + kLong.size());
  for (const PublishedRow& row : published_table())
    if (name == row.sequence || name == row.sequence.substr(row.sequence.find('_') + 1)) return row;
  return std::nullopt;
}

std::string published_notes(const std::vector<std::string>& sequences) {
  std::vector<std::string> namesakes;
  bool sitting_static = false;
  for (const std::string& sequence : sequences) {
    const auto row = published_row(sequence);
    if (!row) continue;
    // TUM's own have the camera in their names; a generated kind, or a folder of one, has not.
    const std::string kind = row->sequence.substr(row->sequence.find('_') + 1);
    if (sequence == kind || sequence == fmt::format("generated:{}", kind)) namesakes.push_back(sequence);
    sitting_static = sitting_static || kind == "sitting_static";
  }
  std::string text;
  if (!namesakes.empty())
    text += fmt::format(
        "- published figures beside {} are of TUM's sequences of these names, not of these frames\n",
        fmt::join(namesakes, ", "));
  if (sitting_static)
    text +=
        "- BaMVO's 0.015700 on sitting_static is as Niu & Li quote it; Xu et al. (2022) give 0.0248, and "
        "0.0157 is DVO's\n";
  return text;
}

Table table_one(const std::vector<BenchmarkRow>& rows, const std::vector<std::string>& methods,
                const std::string& baseline) {
  Table table;
  table.header = {"RPE 1 s, RMSE [m]", "ORB-SLAM2 VO",  "paper, published",
                  "Gao 2019, quoted",  "BaMVO, quoted", "published gain"};
  const auto is_outside = [&rows](const std::string& method) {
    return std::any_of(rows.begin(), rows.end(), [&method](const BenchmarkRow& row) {
      const BenchmarkCell* cell = find_cell(row, method);
      return cell != nullptr && cell->outside;
    });
  };
  for (const std::string& method : methods)
    table.header.push_back(is_outside(method) ? method : "ours: " + method);
  for (const std::string& method : methods)
    if (method != baseline) table.header.push_back("gain: " + method);

  GainColumn published_gain;
  std::vector<GainColumn> gains(methods.size());
  for (const BenchmarkRow& row : rows) {
    std::vector<std::string> cells = {row.sequence};
    if (const auto published = published_row(row.sequence)) {
      cells.insert(cells.end(), {metres(published->orb_slam2_vo), metres(published->paper),
                                 published->ref7 ? metres(published->ref7) : "lost", metres(published->ref12),
                                 published_gain.add(1.0 - published->paper / published->orb_slam2_vo)});
    } else {
      cells.insert(cells.end(), 5, kNoFigure);
    }
    for (const std::string& method : methods) cells.push_back(cell_text(find_cell(row, method)));
    for (std::size_t i = 0; i < methods.size(); ++i)
      if (methods[i] != baseline) cells.push_back(gains[i].add(gain_over(row, baseline, methods[i])));
    table.rows.push_back(std::move(cells));
  }

  std::vector<std::string> last = {"mean gain", "", "", "", "", published_gain.mean()};
  last.insert(last.end(), methods.size(), "");
  for (std::size_t i = 0; i < methods.size(); ++i)
    if (methods[i] != baseline) last.push_back(gains[i].mean());
  table.rows.push_back(std::move(last));
  return table;
}

}  // namespace stillpoint
