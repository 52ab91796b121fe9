#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <future>
#include <memory>
#include <optional>

#include "app/arguments.hpp"
#include "app/commands.hpp"
#include "app/open_source.hpp"
#include "app/painter.hpp"
#include "app/progress.hpp"
#include "app/snapshot_files.hpp"
#include "core/counted.hpp"
#include "core/error.hpp"
#include "core/inspect/frame_ranges.hpp"
#include "core/inspect/run_view.hpp"
#include "core/median.hpp"
#include "core/motion/methods.hpp"
#include "core/run/condition.hpp"
#include "core/run/method_needs.hpp"
#include "ui/session/session.hpp"
#include "ui/shell/event_log.hpp"
#include "ui/theme/theme.hpp"
#include "ui/workbench/settings.hpp"

namespace stillpoint {
namespace {

struct SnapshotArguments {
  SourceArguments place;
  std::string out, video, frames, when, panels, size, theme = "dark", layout;
  double scale = 1.0, fps = 0.0;     ///< fps: 0 = frames' own times
  std::vector<std::string> compare;  ///< methods and presets that run beside
  std::vector<std::string> wipe;     ///< lists of runs by name; empty = none
  std::string flip;                  ///< a run by name; empty = none
  std::vector<std::string> plots;    ///< kinds of file for plots and tables; empty = none are written
  std::string beside;                ///< method whose stages are laid beside the run's; empty = none
  bool force = false, no_baseline = false, timings = false;
};

/// The names in lists, of which one may hold a comma that is written \,.
/// @throws InputError for a list without any
std::vector<std::string> names_in(const std::vector<std::string>& lists, const char* option) {
  std::vector<std::string> names;
  for (const std::string& list : lists) {
    const std::vector<std::string> some = split_names(list);
    if (some.empty()) throw InputError(fmt::format("{} '{}': names nothing", option, list));
    names.insert(names.end(), some.begin(), some.end());
  }
  return names;
}

PainterOptions painter_options(const SnapshotArguments& arguments) {
  PainterOptions options;
  options.panels = arguments.panels;
  if (options.panels.empty()) options.panels = arguments.out.empty() ? "workbench" : "all";
  if (!arguments.size.empty()) options.workbench_size = options.panel_size = parse_size(arguments.size);
  options.look = {parse_theme(arguments.theme), static_cast<float>(arguments.scale)};
  options.layout = arguments.layout;
  options.offers = !arguments.plots.empty();
  if (!arguments.wipe.empty()) {
    options.runs.pictures = RunPictures::wiped;
    const std::vector<std::string> names = names_in(arguments.wipe, "--wipe");
    if (names != std::vector<std::string>{"all"}) options.runs.only = names;
  }
  if (!arguments.flip.empty())
    options.runs = {.pictures = RunPictures::flipped, .only = {arguments.flip}, .flipped_to = arguments.flip};
  return options;
}

/// Runs beside the session's own, each from the first frame on.
void add_compared(Session& session, const SnapshotArguments& arguments, const Config& config) {
  for (const std::string& name : names_in(arguments.compare, "--compare")) {
    const std::vector<std::string> methods = method_names();
    Config other = config;
    if (std::find(methods.begin(), methods.end(), name) != methods.end())
      other.run.method = name;
    else
      other = load_config(name);
    session.request(request::AddGhost{other, name, 0});
    if (const auto view = session.view(); !view->message.empty())
      throw InputError(fmt::format("--compare {}: {}", name, view->message));
  }
}

/// @throws InputError for a run that pictures are to show and there is not
void refuse_unknown_runs(const SessionView& view, const RunsShown& runs) {
  std::vector<std::string> known, with_pictures;
  for (const ListedRun& run : listed_runs(view)) {
    known.push_back(run.name);
    if (!run.never_has_pictures) with_pictures.push_back(run.name);
  }
  for (const std::string& name : runs.only)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw InputError(fmt::format("there is no run {}; there are {}", name, fmt::join(known, ", ")));
  constexpr const char* kAdd = "--compare METHOD and --run NAME=FOLDER lay others beside";
  if (runs.pictures == RunPictures::wiped && runs.chosen_of(view).size() < 2) {
    if (!runs.only.empty())
      throw InputError(
          fmt::format("--wipe takes two runs at least; there are {}. {}", fmt::join(known, ", "), kAdd));
    throw InputError(
        fmt::format("--wipe takes two runs with pictures at least, and of {} only {} has any. {}",
                    fmt::join(known, ", "), fmt::join(with_pictures, ", "), kAdd));
  }
  if (const auto flipped = runs.flipped(view); flipped && flipped->never_has_pictures)
    throw InputError(fmt::format("--flip {}: {}", flipped->name, flipped->no_pictures));
}

/// Frames of which the run that pictures are of has none.
class FramesWithout {
 public:
  /// Counts the frame shown, where it is one. @returns whether it is
  bool take(const SessionView& view, const RunsShown& runs) {
    const auto flipped = runs.flipped(view);
    if (!flipped || flipped->no_pictures.empty()) return false;
    if (++count_ == 1) why_ = fmt::format("--flip {}: {}", flipped->name, flipped->no_pictures);
    return true;
  }
  /// @throws InputError where these are all there are
  void tell(std::size_t of) const {
    if (count_ == 0) return;
    if (count_ == of) throw InputError(why_);
    fmt::print(stderr, "stillpoint: warning: {} of {} are left out: {}\n", count_, counted(of, "frame"),
               why_);
  }

 private:
  std::size_t count_ = 0;
  std::string why_;
};

/// Whether the pictures show what a method's stages made.
bool show_stages(const PictureChoice& chosen) {
  constexpr std::array kShow = {"workbench", "motion", "stages", "feature", "inspector"};
  return std::any_of(kShow.begin(), kShow.end(), [&](const char* name) { return chosen.draws(name); });
}

/// The median time between two frames, s.
double usual_step(const FrameSource& source) {
  std::vector<double> steps;
  for (int i = 1; i < source.size(); ++i) steps.push_back(source.timestamp(i) - source.timestamp(i - 1));
  constexpr double kOfOneFrame = 1.0 / 30.0;  // s: a single frame is shown as long as a Kinect's
  return steps.empty() ? kOfOneFrame : std::clamp(median_of(steps), 1.0 / 240.0, 10.0);
}

std::optional<Condition> when_condition(const SnapshotArguments& arguments) {
  if (arguments.when.empty()) return std::nullopt;
  try {
    return Condition(arguments.when);
  } catch (const ConditionError& error) {
    throw InputError(
        fmt::format("--when: {}\n  {}\n  {:>{}}", error.what(), arguments.when, "^", error.column() + 1));
  }
}

/// Those of `frames` at which the condition holds.
/// @throws InputError where there are none, with how near it came
std::vector<int> frames_where(const Condition& condition, const RunView& run,
                              const std::vector<int>& frames) {
  const FrameFigures figures(run.measured());
  std::vector<int> chosen;
  for (const int frame : condition.frames(figures))
    if (std::binary_search(frames.begin(), frames.end(), frame)) chosen.push_back(frame);
  if (chosen.empty()) {
    const std::string reach = condition.reach(figures, frames);
    throw InputError(fmt::format("--when '{}': holds at none of {}, and nothing is drawn{}{}",
                                 condition.text(), counted(frames.size(), "frame"), reach.empty() ? "" : "; ",
                                 reach));
  }
  if (const auto unknown = condition.unknown_figures(figures); !unknown.empty())
    fmt::print(stderr, "stillpoint: warning: --when: no frame has {}\n", fmt::join(unknown, ", "));
  return chosen;
}

/// A session on its way to the first frame that is drawn, while what draws it is set up.
class EarlySession {
 public:
  /// @param prepare before its first frame @param first frame; nothing where it is not known yet
  EarlySession(const OpenedSource& place, const std::function<void(Session&)>& prepare,
               std::optional<int> first)
      : making_(std::async(std::launch::async, [this, &place, prepare, first] {
          auto session = std::make_unique<Session>(place.source, place.config, place.options);
          prepare(*session);
          // One far ahead is waited for with a bar that tells how far it is.
          constexpr int kMostFrames = 8;
          if (first && *first < kMostFrames)
            session->go_to(*first, [this](const FrameRecord& record) { seen_.push_back(record.status); });
          return session;
        })) {}
  /// @param on_frame told of each frame that was processed meanwhile
  [[nodiscard]] std::unique_ptr<Session> get(const std::function<void(FrameStatus)>& on_frame) {
    auto session = making_.get();
    for (const FrameStatus status : seen_) on_frame(status);
    return session;
  }

 private:
  std::vector<FrameStatus> seen_;
  std::future<std::unique_ptr<Session>> making_;  // last: it ends before what it works with
};

/// @throws CLI::Error for what goes together with no sequence
PictureChoice asked_for(const SnapshotArguments& arguments, const PainterOptions& options) {
  PictureChoice chosen = choose_pictures(options);
  if (arguments.out.empty() && arguments.video.empty()) throw CLI::RequiredError("--out or --video");
  if (!arguments.plots.empty() && arguments.out.empty())
    throw_usage("--plots: goes with --out, and is of no use here");
  if (arguments.fps > 0 && arguments.video.empty())
    throw_usage("--fps: goes with --video, and is of no use here");
  if (!arguments.video.empty() && chosen.count() != 1)
    throw InputError(
        fmt::format("--video takes one picture of each frame, and --panels names {}", chosen.count()));
  return chosen;
}

void snapshot(const SnapshotArguments& arguments) {
  const std::optional<Condition> condition = when_condition(arguments);
  PainterOptions options = painter_options(arguments);
  const PictureChoice chosen = asked_for(arguments, options);
  OpenedSource place = open_source(arguments.place);
  const bool finished_run = place.options.recorded != nullptr;
  warn_once(place.options.no_images);
  if (!finished_run)
    if (const std::string why = why_no_masks(place.config, *place.source); !why.empty())
      throw InputError(why);
  const std::string& method = place.config.run.method;
  const std::string wanted = !arguments.frames.empty() ? arguments.frames : condition ? "0:" : "-1";
  std::vector<int> frames = parse_frame_ranges(wanted, place.source->size());
  place.options.keep_times = arguments.timings || finished_run;
  place.options.baseline = !arguments.no_baseline;
  if (arguments.no_baseline) place.options.recorded_baseline = nullptr;
  // The records of a finished run hold all but the stages.
  place.options.catch_up = method_named(method).needs.keeps_state && show_stages(chosen);
  options.method = method;
  options.stereo = place.source->camera().is_stereo();
  throw_if_among_data(arguments.out, {arguments.place.place});
  SnapshotFiles pictures({arguments.out, arguments.plots, arguments.video, arguments.fps, arguments.force},
                         chosen.workbench ? options.workbench_size : options.panel_size,
                         usual_step(*place.source));
  const auto prepare = [&](Session& session) {
    if (!arguments.beside.empty()) session.request(request::StagesBeside{arguments.beside});
    add_compared(session, arguments, place.config);
    refuse_unknown_runs(*session.view(), options.runs);
    session.request_baseline(options.runs.wants_baseline(*session.view()));
  };
  EarlySession early(place, prepare, condition ? std::nullopt : std::optional(frames.front()));
  Painter painter(options, chosen);
  FramesWithout without;
  bool chosen_all = !condition;  // which frames are drawn is known
  {
    Progress progress(fmt::format("{} ({})", place.source->name(), method), frames.back() + 1);
    const auto on_status = [&](FrameStatus status) {
      progress.advance(std::string(to_string(status)));
      throw_if_interrupted();
    };
    const auto on_frame = [&](const FrameRecord& record) { on_status(record.status); };
    try {
      const auto session = early.get(on_status);
      if (condition) {
        session->go_to(frames.back(), on_frame);
        frames = frames_where(*condition, *session->view()->run, frames);
        chosen_all = true;
      }
      for (const int frame : frames) {
        session->go_to(frame, on_frame);
        if (without.take(*session->view(), options.runs)) continue;
        if (chosen.draws("stages") || chosen.draws("workbench")) session->complete();
        pictures.add(*session->view(), painter);
        throw_if_interrupted();
      }
    } catch (const Interrupted&) {  // what was drawn is kept; it is thrown again below
    }
  }
  if (const auto left = painter.choices_left(); !left.empty())
    fmt::print(stderr, "stillpoint: warning: {}: no control could take {}\n", arguments.layout,
               fmt::join(left, ", "));
  without.tell(frames.size());
  fmt::print("{}", pictures.finish());
  throw_if_interrupted(
      fmt::format("stopped after {}; what was drawn is kept",
                  chosen_all ? fmt::format("{} of {}", pictures.frames(), counted(frames.size(), "frame"))
                             : counted(pictures.frames(), "frame")));
}

}  // namespace

void add_snapshot_command(CLI::App& app) {
  const auto arguments = std::make_shared<SnapshotArguments>();
  CLI::App* command = app.add_subcommand(
      "snapshot",
      "Panels of the workbench as images or a video, without a display: masks, trajectory, plots");
  command->add_option("SEQUENCE", arguments->place.place, kSequenceOrRunHelp)->required();
  command->add_option(
      "--frames", arguments->frames,
      "Frames to draw: 10, 20:40:5 (40 not among them), -1 is the last, and what is drawn when nothing "
      "is said; with commas between");
  command->add_option(
      "--when", arguments->when,
      "Draw only frames at which a condition holds, such as 'rpe > 5 cm || lost', among all or those of "
      "--frames; the status is 1 where there is none; `stillpoint run --break help` tells of conditions");
  command->add_option("--panels", arguments->panels,
                      "all (otherwise), workbench, or panels' names with commas between");
  command->add_option("--out", arguments->out, "Folder for the images, FRAME_PANEL.png; made if missing");
  command
      ->add_option(
          "--plots", arguments->plots,
          "Write what a right click saves in the window as well: plots as svg, pdf or csv, tables as "
          "csv; FRAME_PANEL_NAME.svg; with commas between")
      ->delimiter(',')
      ->check(CLI::IsMember({"svg", "pdf", "csv"}))
      ->allow_extra_args(false);
  command->add_option("--video", arguments->video,
                      "A video of the frames, .mp4, .mkv or .avi: of the workbench, or of the panel named");
  command
      ->add_option("--fps", arguments->fps,
                   "Frames a second of the video; otherwise each is shown at its own time (.mp4, .mkv)")
      ->check(number_between(0.1, 240.0));
  const PainterOptions sizes;
  command->add_option("--size", arguments->size,
                      fmt::format("Of an image, px; otherwise {}x{} for the workbench and {}x{} for a panel",
                                  sizes.workbench_size.first, sizes.workbench_size.second,
                                  sizes.panel_size.first, sizes.panel_size.second));
  command->add_option("--scale", arguments->scale, "Of text and spacing")->check(number_between(0.5, 4.0));
  command->add_option("--theme", arguments->theme, "dark or light")->capture_default_str();
  command->add_option(
      "--layout", arguments->layout,
      "The workbench's tiles and what is chosen in each panel, a JSON file; single panels take their "
      "choices from it");
  command
      ->add_option("--beside", arguments->beside,
                   "Another method, whose stages are worked out for each frame as well: what its own panels "
                   "show")
      ->check(CLI::IsMember(method_names()));
  command->add_option(
      "--compare", arguments->compare,
      "Other methods or presets that run beside, with commas between (\\, is a comma within a "
      "name); may be given again");
  CLI::Option* wipe = command->add_option(
      "--wipe", arguments->wipe,
      "Pictures show several runs, each in a strip: all, or names of runs with commas between (\\, is a "
      "comma "
      "within a name), as a picture has them: the baseline's is 'none (baseline)'; may be given again");
  command
      ->add_option("--flip", arguments->flip,
                   "Pictures are of this run, by its name, in place of the sequence's own")
      ->excludes(wipe);
  wipe->allow_extra_args(false);
  command->add_flag("--no-baseline", arguments->no_baseline, "Do not run method none beside for comparison");
  command->add_flag("--timings", arguments->timings, "Show stage times, which differ from run to run");
  command->add_flag("--force", arguments->force, "Overwrite earlier images");
  arguments->place.source.add_to(*command, "--length");
  arguments->place.add_to(*command);
  arguments->place.config.add_to(*command, true);
  command->callback([arguments] { snapshot(*arguments); });
}

}  // namespace stillpoint
