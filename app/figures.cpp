#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "app/commands.hpp"
#include "app/open_source.hpp"
#include "app/painter.hpp"
#include "app/progress.hpp"
#include "core/error.hpp"
#include "core/inspect/frame_ranges.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/engines.hpp"
#include "core/out_folder.hpp"
#include "ui/panels/figure_sheet.hpp"
#include "ui/session/session.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/theme/theme.hpp"
#include "ui/workbench/settings.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

constexpr std::pair<int, int> kFigureSize = {960, 780};  // px, of one panel
constexpr const char* kList = "figures.txt";

struct FiguresArguments {
  SourceArguments place;
  std::string out, frame, theme = "light";
  double scale = 1.0;
  bool force = false;
};

/// The first method that has a panel for its stages; null where none has.
const MethodInfo* method_with_panel(const std::string& panel) {
  for (const MethodInfo& method : methods())
    if (std::find(method.panels.begin(), method.panels.end(), panel) != method.panels.end()) return &method;
  return nullptr;
}

/// The figures of one frame, written one by one, with the list of what each shows.
class Figures {
 public:
  Figures(const FiguresArguments& arguments, const std::string& method)
      : folder_(arguments.out),
        scale_(arguments.scale),
        painter_({.look = {parse_theme(arguments.theme)}, .method = method}) {}

  void write_figure_1(const SessionView& view) {
    const std::vector<FigureCell> cells = figure_1_cells(view);
    if (cells.empty()) {
      leave_out("figure 1 is", "this frame has no motion mask, for want of an earlier frame or of tracks");
      return;
    }
    const std::string where =
        fmt::format("{}, frames {} and {}", view.title, view.current->reference.index, view.current->index);
    for (const FigureCell& cell : cells) {
      // Each alone as well, for pages that set their own captions.
      write_image(folder_ / fmt::format("figure1{}.png", cell.letter), cell.picture);
    }
    const std::string& method = stages_with(*view.current, "union_mask")->method;
    FigureSheet sheet(fmt::format("Figure 1   Motion mask by method {}: {}", method, where), cells, 3);
    write("1", painter_.paint_frame([&](UiFrame& frame) { sheet.draw(frame); }, sheet.size(scale_)),
          fmt::format("frames, compensated frame, forward, backward and union mask by method {} of {}; "
                      "figure1a.png to figure1f.png are its pictures alone",
                      method, where));
  }

  void write_panel(const std::string& number, const SessionView& view, const std::string& panel,
                   const std::string& shows) {
    write(number, painter_.paint_panel(view, panel, kFigureSize), shows);
  }

  /// @param which "figure 1 is", "figures 3 and 4 are"
  void leave_out(const std::string& which, const std::string& why) {
    list_ += fmt::format("{} left out: {}\n", which, why);
  }

  /// @returns the list
  std::string finish() {
    write_text_file(folder_ / kList, list_);
    return list_;
  }

 private:
  void write(const std::string& number, const cv::Mat& image, const std::string& shows) {
    const std::string name = fmt::format("figure{}.png", number);
    write_image(folder_ / name, image);
    list_ += fmt::format("{}: {}\n", name, shows);
  }

  fs::path folder_;
  double scale_;
  Painter painter_;
  std::string list_;
};

void figures(const FiguresArguments& arguments) {
  const NewFolders made(arguments.out);
  OpenedSource place = open_source(arguments.place);
  if (!place.options.no_images.empty()) throw InputError(place.options.no_images);
  const std::vector<int> frames = parse_frame_ranges(arguments.frame, place.frames, "--frame");
  if (frames.size() != 1)
    throw InputError(
        fmt::format("--frame {}: names {} frames, and figures are of one", arguments.frame, frames.size()));
  const int frame = frames.front();
  const std::string& method = place.config.run.method;
  const std::string outside = place.options.recorded ? place.options.recorded->outside : std::string();
  const std::string whose = outside.empty() ? "method " + method : "another program's run " + outside;
  const bool has_depth = place.source->has_depth(), has_truth = !place.source->ground_truth().empty();
  Figures output(arguments, method);
  prepare_out_folder(arguments.out, {kList}, arguments.force);

  if (place.options.recorded == nullptr) place.options.keep_times = false;
  Session session(place.source, place.config, place.options);
  if (const MethodInfo* shows = method_with_panel("compensated"); shows != nullptr && shows->name != method)
    session.request(request::StagesBeside{shows->name});
  {
    // Errors are drawn over the whole sequence.
    const int last = has_depth && has_truth ? place.frames - 1 : frame;
    Progress progress(fmt::format("{} ({})", place.source->name(), method), last + 1);
    session.go_to(last, [&](const FrameRecord& record) {
      progress.advance(std::string(to_string(record.status)));
      throw_if_interrupted("stopped before it was done; no figure was drawn");
    });
    session.go_to(frame);
    throw_if_interrupted("stopped before it was done; no figure was drawn");
  }
  const auto view = session.view();
  output.write_figure_1(*view);
  const std::string beside = view->baseline ? " and of method " + view->baseline->name : "";
  const FrameRecord* record = view->current->record;
  if (has_depth && record != nullptr && !record->measured.features) {
    output.leave_out("figures 3 and 4 are",
                     fmt::format("{} left no features of frame {}", maker_of(*view), frame));
  } else if (has_depth) {
    output.write_panel("3", *view, "features_before",
                       fmt::format("features before removal, those that {} removes told apart", whose));
    output.write_panel("4", *view, "features_after",
                       "features after removal, and what tracking made of them");
  } else {
    output.leave_out("figures 3 and 4 are",
                     "the sequence has no depth, and features are those of the odometry");
  }
  if (has_depth && outside.empty() && engine_of(place.config).has_stages)
    output.write_panel("_odometry", *view, "motion",
                       fmt::format("stages of odometry {} at a glance, after those of method {}",
                                   place.config.run.odometry, method));
  if (has_depth && has_truth)
    output.write_panel("6", *view, "errors",
                       fmt::format("relative pose error over time of {}{}", whose, beside));
  else
    output.leave_out("figure 6 is", "errors need depth and ground truth, and the sequence lacks one of them");
  fmt::print("{}written to {}\n", output.finish(), arguments.out);
}

}  // namespace

void add_figures_command(CLI::App& app) {
  const auto arguments = std::make_shared<FiguresArguments>();
  CLI::App* command = app.add_subcommand(
      "figures", "The paper's figures 1, 3, 4 and 6 from any sequence: masks, features, errors over time");
  command->add_option("SEQUENCE", arguments->place.place, kSequenceOrRunHelp)->required();
  command->add_option("--frame", arguments->frame, "The frame that figures 1, 3 and 4 show; -1 is the last")
      ->required();
  command->add_option("--out", arguments->out, "Folder for the figures; made if missing")->required();
  command->add_option("--theme", arguments->theme, "light or dark")->capture_default_str();
  command->add_option("--scale", arguments->scale, "Of the pictures in figure 1; 1 keeps their pixels")
      ->check(number_between(0.1, 4.0))
      ->capture_default_str();
  command->add_flag("--force", arguments->force, "Overwrite earlier figures");
  arguments->place.source.add_to(*command);
  arguments->place.add_to(*command);
  arguments->place.config.add_to(*command, true);
  command->callback([arguments] { figures(*arguments); });
}

}  // namespace stillpoint
