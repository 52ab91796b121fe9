#pragma once

#include <functional>
#include <string>

#include "core/evaluation/benchmark_results.hpp"
#include "core/evaluation/tables.hpp"

namespace stillpoint {

// Tables in pages, made from a benchmark's results. A Markdown page marks where one stands:
//
//   <!-- table: results/table1.json rpe methods=none,paper,stillpoint -->
//   …
//   <!-- end of table -->
//
// The first word names the results, from the page's folder; the second what is shown, a row a sequence and a
// column a method:
//   rpe rpe_deg ate rpe_frame   errors, m (rpe_deg: degrees); "lost" where less than half the frames have a
//                               pose, and how many have one where not all do
//   gain                        the share by which the RPE fell against the baseline behind the same engine
//   iou precision recall        of masks
//   right                       of the features removed, the share on what is dynamic
//   ms p99 units                time a frame
//   lost                        frames without a pose
//   spread                      median RPE and half the distance of its quartiles, of a benchmark's --repeat
//   published                   Table 1 of the paper with our columns beside it
//   ablation                    of an ablation's results, a row an ingredient: what leaving it out changed
//   made                        no table: what the results were made by, in a sentence
// Choices: methods=A,B and odometry=A,B (both in the order of the columns; otherwise all there are);
// sequences=A,B (a name, or its beginning followed by *); names=long keeps `generated:` before names.

/// Where a page's figures come from, by the name of the file that a table names.
struct TableSources {
  std::function<BenchmarkResults(const std::string& file)> results;
  std::function<Table(const std::string& file)> ablation;
  std::function<Provenance(const std::string& file)> provenance;
};

/// The page with every marked table made anew; all else as it was.
/// @param where names the page in messages
/// @param baseline the method that gains are over
/// @throws InputError in one sentence for a table that names what there is not, or has no end
[[nodiscard]] std::string with_tables(const std::string& page, const std::string& where,
                                      const std::string& baseline, const TableSources& sources);

}  // namespace stillpoint
