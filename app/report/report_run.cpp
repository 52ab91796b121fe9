#include "app/report/report_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "app/open_source.hpp"
#include "app/progress.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/motion/methods.hpp"
#include "core/odometry/engines.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

std::string folder_name(const std::string& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return path.has_filename() ? path.filename().string() : path.parent_path().filename().string();
}

/// By method where that is enough, else by folder as well.
void label_runs(ReportGroup& group) {
  std::map<std::string, int> methods, labels;
  for (const ReportRun& run : group.runs) ++methods[run_name(run.recorded())];
  for (ReportRun& run : group.runs) {
    run.label = run_name(run.recorded());
    const std::string name = folder_name(run.folder);
    if (methods[run.label] > 1 && name != run.label) run.label += fmt::format(" ({})", name);
    const int times = ++labels[run.label];
    if (times > 1) run.label += fmt::format(" {}", times);
  }
}

/// Groups of one sequence's name are told apart by how many frames they are of, and where that is the same by
/// number; why they do not stand together is said.
void name_groups(std::vector<ReportGroup>& groups) {
  std::map<std::string, int> names, taken;
  for (const ReportGroup& group : groups) ++names[group.sequence];
  for (ReportGroup& group : groups) {
    if (names[group.sequence] < 2) continue;
    group.warnings.push_back(fmt::format(
        "Other runs here are of other frames of a sequence called {}; they stand apart, for errors "
        "of different frames do not compare.",
        group.sequence));
    group.sequence += ", " + counted(group.runs.front().result().frames_in_sequence, "frame");
    if (const int times = ++taken[group.sequence]; times > 1) group.sequence += fmt::format(" ({})", times);
  }
}

}  // namespace

const ReportRun* ReportGroup::baseline() const {
  const auto it = std::find_if(runs.begin(), runs.end(), [](const ReportRun& run) {
    return run.recorded().outside.empty() && method_named(run.report.method).baseline;
  });
  return it == runs.end() ? nullptr : &*it;
}

std::vector<ReportGroup> open_report_runs(const std::vector<std::string>& folders) {
  std::vector<ReportGroup> groups;
  std::vector<std::string> fingerprints;
  std::set<fs::path> taken;
  for (const std::string& folder : folders) {
    std::error_code ignored;
    if (!taken.insert(fs::weakly_canonical(folder, ignored)).second)
      throw InputError(fmt::format("{}: is named twice", folder));
    throw_if_interrupted("stopped before it was done; no report was written");
    ReportRun run{folder, "", open_run_and_tell(folder), {}};
    warn_once(run.opened.no_images);
    if (run.result().records.empty()) throw InputError(fmt::format("{}: is a run without frames", folder));
    run.report = report_on(run.result(), *run.opened.source);
    const std::string& print = run.recorded().origin.fingerprint;
    const auto known = std::find(fingerprints.begin(), fingerprints.end(), print);
    const auto place = static_cast<std::size_t>(known - fingerprints.begin());
    if (known == fingerprints.end()) {
      fingerprints.push_back(print);
      groups.push_back({run.report.sequence, {}, {}});
    }
    ReportGroup& group = groups[place];
    const std::string& no_images = run.opened.no_images;
    for (const std::string& warning :
         {no_images.empty() ? no_images : "Without images: " + no_images, run.recorded().cut_short})
      if (!warning.empty() &&
          std::find(group.warnings.begin(), group.warnings.end(), warning) == group.warnings.end())
        group.warnings.push_back(warning);
    group.runs.push_back(std::move(run));
  }
  for (ReportGroup& group : groups) label_runs(group);
  name_groups(groups);
  return groups;
}

}  // namespace stillpoint
