#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/layered_frames.hpp"
#include "app/progress.hpp"
#include "app/report/html.hpp"
#include "app/report/live_data.hpp"
#include "app/report/live_page.hpp"
#include "app/report/live_pictures.hpp"
#include "app/report/report_comparison.hpp"
#include "app/report/report_pictures.hpp"
#include "app/report/report_run.hpp"
#include "app/report/report_sections.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/inspect/run_view.hpp"
#include "core/out_folder.hpp"
#include "ui/shell/event_log.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::vector<std::string> runs;
  std::string out;
  int worst = 3;
  bool force = false, interactive = false;
  LivePictureOptions pictures;
};

std::string title_of(const std::vector<ReportGroup>& groups) {
  return groups.size() == 1 ? fmt::format("{}: odometry runs", groups.front().sequence)
                            : fmt::format("Odometry runs of {} sequences", groups.size());
}

/// The room for pictures is shared by the sequences.
std::vector<LivePictures> pictures_of(const std::vector<ReportGroup>& groups,
                                      const ReportArguments& arguments, const ReportProgress& progress) {
  std::vector<LivePictures> pictures;
  std::set<std::string> found;
  const auto room =
      static_cast<std::size_t>(arguments.pictures.most_mb * 1e6 / static_cast<double>(groups.size()));
  for (const ReportGroup& group : groups)
    pictures.push_back(live_pictures(group, arguments.pictures, room, arguments.worst, found, progress));
  check_layers(arguments.pictures.layers, found);
  return pictures;
}

void report(const ReportArguments& arguments) {
  check_out_file(arguments.out, arguments.force);
  const std::vector<ReportGroup> groups = open_report_runs(arguments.runs);
  Painter painter({.look = {ThemeName::kLight}});
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const ReportProgress progress = [terminal](const std::string& what) {
    if (terminal) {
      fmt::print(stderr, "\r\033[K{}", what);
      std::fflush(stderr);
    }
    if (terminal && stop_requested()) std::fputs("\r\033[K", stderr);
    throw_if_interrupted("stopped before it was done; no report was written");
  };
  std::string body = introduction(groups), scripts, told;
  if (arguments.interactive) {
    std::vector<LivePictures> pictures = pictures_of(groups, arguments, progress);
    for (std::size_t i = 0; i < groups.size(); ++i)
      told += (groups.size() > 1 ? groups[i].sequence + ": " : "") + pictures_text(pictures[i]) + "\n";
    body += live_markup();
    scripts = live_scripts(live_data(groups, pictures));
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const ReportGroup& group = groups[i];
    body += fmt::format("<h2 id=\"sequence{}\">{}</h2>\n", i + 1, escaped(group.sequence));
    body += summary_table(group, arguments.worst);
    if (!arguments.interactive) {
      progress(group.sequence + ": errors and trajectories");
      body += "<h3>Error over time</h3>\n" + error_plots(painter, group);
      body += "<h3>Trajectories</h3>\n" + paths_compared(group) + trajectories(painter, group);
    }
    body += one_frame_compared(painter, group, progress);
    body += "<h3>Stage timings</h3>\n" + stage_timings(group);
    for (std::size_t run = 0; run < group.runs.size(); ++run) {
      const std::string link =
          arguments.interactive ? fmt::format("#frame={{}}&run={}&sequence={}", run + 1, i + 1) : "";
      body += worst_frame_panels(painter, group, group.runs[run], arguments.worst, link, progress);
    }
  }
  body += configurations(groups) + provenance(groups) + scripts;
  if (terminal) std::fputs("\r\033[K", stderr);
  const std::string page =
      page_html(title_of(groups), body, arguments.interactive ? live_style() : std::string());
  write_text_file(arguments.out, page);
  fmt::print("{}, {:.1f} MB, written to {}\n{}", counted(arguments.runs.size(), "run"),
             static_cast<double>(page.size()) / 1e6, arguments.out, told);
}

}  // namespace

void add_report_command(CLI::App& app) {
  const auto arguments = std::make_shared<ReportArguments>();
  CLI::App* command = app.add_subcommand(
      "report", "Finished runs side by side on one page: tables, plots, trajectories and worst frames");
  command->add_option("RUNS", arguments->runs, "Folders that `stillpoint run` or `benchmark` wrote")
      ->required();
  command->add_option("--out", arguments->out, "The page, one HTML file with its pictures in it")->required();
  command
      ->add_option(
          "--worst", arguments->worst,
          fmt::format(
              "How many of each run's worst frames to show; each is {} frames or more from a worse one",
              kWorstApart))
      ->check(CLI::Range(0, 100))
      ->capture_default_str();
  CLI::Option* interactive = command->add_flag("--interactive", arguments->interactive,
                                               "A page to go about in: trajectories to turn, plots, frames "
                                               "and table with one cursor; needs a browser's "
                                               "scripts, but no network");
  command
      ->add_option("--picture-width", arguments->pictures.width,
                   "Its pictures are made no wider than this [px]")
      ->check(CLI::Range(32, 8192))
      ->capture_default_str()
      ->needs(interactive);
  command
      ->add_option("--picture-mb", arguments->pictures.most_mb,
                   "Room for its pictures [MB]; where all frames need more, some are left out")
      ->check(number_between(0.0, 1000.0))
      ->capture_default_str()
      ->needs(interactive);
  command
      ->add_option(
          "--layers", arguments->pictures.layers,
          "Ids of stages' layers to lay over its pictures, with commas between: difference,forward_mask")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->needs(interactive);
  command->add_flag("--force", arguments->force, "Overwrite an earlier report");
  command->callback([arguments] { report(*arguments); });
}

}  // namespace stillpoint
