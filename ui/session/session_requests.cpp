// The part of Session that carries out what panels ask for.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/check/check_sequence.hpp"
#include "core/error.hpp"
#include "core/inspect/drawn_truth.hpp"
#include "core/inspect/export_session.hpp"
#include "core/inspect/run_view.hpp"
#include "core/out_folder.hpp"
#include "core/run/method_needs.hpp"
#include "core/run/sweep.hpp"
#include "ui/session/session.hpp"

namespace stillpoint {
namespace {

constexpr const char* kNoOthers = "No other parameters can be tried";

/// @throws InputError for a number that its parameter does not allow
void refuse_out_of_range(Config config) {
  for (const Parameter& parameter : parameters(config)) {
    const double value = number_of(parameter).value_or(parameter.min);
    if (!(value >= parameter.min && value <= parameter.max))
      throw InputError(fmt::format("{} is {}, expected {} to {}{}{}", parameter.key, value, parameter.min,
                                   parameter.max, parameter.unit.empty() ? "" : " ", parameter.unit));
    const auto* text = std::get_if<std::string*>(&parameter.value);
    if (text != nullptr && !parameter.choices.empty() &&
        std::find(parameter.choices.begin(), parameter.choices.end(), **text) == parameter.choices.end())
      throw InputError(
          fmt::format("{} is {}, expected {}", parameter.key, **text, fmt::join(parameter.choices, ", ")));
  }
}

}  // namespace

void Session::refuse_without_images(const char* what) const {
  if (!options_.no_images.empty()) throw InputError(fmt::format("{}: {}", what, options_.no_images));
}

void Session::request(SessionRequest wanted) {
  if (worker_.joinable()) {
    const std::lock_guard lock(mutex_);
    // Of what is asked for faster than it is done, the newest counts.
    if (std::holds_alternative<request::GoTo>(wanted) || std::holds_alternative<request::Preview>(wanted))
      std::erase_if(requests_, [&](const SessionRequest& other) { return other.index() == wanted.index(); });
    requests_.push_back(std::move(wanted));
    asked_.notify_all();
    return;
  }
  message_.clear();
  frame_asked_ = false;
  attempt([&] {
    carry_out(wanted);
    // Play that goes round in a span would never end.
    for (int steps = 0; playing_ && steps <= source_->size(); ++steps) work_step();
    if (frame_asked_ || target_ != current_->index)
      while (!at_rest()) work_step();
    while (has_background()) background_step();
  });
  playing_ = false;
  publish();
}

void Session::carry_out(const SessionRequest& wanted) {
  Marks before = marks();
  std::visit([this](const auto& one) { carry_out(one); }, wanted);
  const bool goes_back =
      std::holds_alternative<request::Undo>(wanted) || std::holds_alternative<request::Redo>(wanted);
  if (!goes_back && marks() != before) remember(std::move(before), wanted.index());
  save_marks();
}

void Session::remember(Marks before, std::size_t request) {
  // What is typed or dragged comes as many requests, and is one change.
  constexpr auto kOneChange = std::chrono::milliseconds(700);
  constexpr std::size_t kKept = 200;
  const auto now = std::chrono::steady_clock::now();
  const bool goes_on = worker_.joinable() && !undo_.empty() && redo_.empty() && request == marked_by_ &&
                       now - marked_at_ < kOneChange;
  marked_by_ = request, marked_at_ = now;
  redo_.clear();
  if (goes_on) return;
  undo_.push_back(std::move(before));
  if (undo_.size() > kKept) undo_.erase(undo_.begin());
}

void Session::set_marks(Marks marks) {
  breakpoints_.set(marks.breakpoints);
  breakpoints_due_ = true;
  debug_.bookmarks = std::move(marks.bookmarks);
  debug_.pins = std::move(marks.pins);
  debug_.drawn = std::move(marks.drawn);
  debug_.span = marks.span, debug_.loop = marks.loop;
}

void Session::carry_out(const request::Undo& /*wanted*/) {
  if (undo_.empty()) return;
  redo_.push_back(marks());
  set_marks(std::move(undo_.back()));
  undo_.pop_back();
}

void Session::carry_out(const request::Redo& /*wanted*/) {
  if (redo_.empty()) return;
  undo_.push_back(marks());
  set_marks(std::move(redo_.back()));
  redo_.pop_back();
}

void Session::carry_out(const request::GoTo& wanted) {
  target_ = std::clamp(wanted.frame, 0, source_->size() - 1);
  frame_asked_ = true;
  debug_.stopped_by.reset();
}

void Session::carry_out(const request::Step& wanted) { carry_out(request::GoTo{target_ + wanted.by}); }

void Session::carry_out(const request::Play& wanted) {
  const bool loops = debug_.loop && debug_.span;
  playing_ = wanted.play && (loops || current_->index + 1 < source_->size());
  debug_.stopped_by.reset();
  if (!playing_ && !frame_asked_) target_ = current_->index;
}

void Session::carry_out(const request::Bookmarks& wanted) {
  debug_.bookmarks = wanted.all;
  for (Bookmark& bookmark : debug_.bookmarks)
    bookmark.frame = std::clamp(bookmark.frame, 0, source_->size() - 1);
  std::stable_sort(debug_.bookmarks.begin(), debug_.bookmarks.end(),
                   [](const Bookmark& a, const Bookmark& b) { return a.frame < b.frame; });
}

void Session::carry_out(const request::Pins& wanted) { debug_.pins = wanted.all; }

void Session::carry_out(const request::Drawn& wanted) { debug_.drawn = wanted.all; }

void Session::carry_out(const request::WriteTruth& /*wanted*/) {
  const std::filesystem::path folder = options_.sidecar ? options_.sidecar->folder : std::filesystem::path();
  if (folder.empty() || options_.recorded)
    throw InputError(fmt::format(
        "{}: is no sequence in a folder, and masks go into one; `stillpoint outline` writes them elsewhere",
        source_->name()));
  refuse_without_images("There is nothing to carry outlines by");
  write_beside(folder.string(), [this, drawn = debug_.drawn, folder](const ExportControl& control) {
    const auto carried = write_drawn_truth(*source_, drawn, folder, control);
    if (!carried) return fmt::format("stopped; the masks in {} are as they were", folder.string());
    masks_written_ = true;
    return fmt::format("{}, written to {}", carried->told(), folder.string());
  });
}

void Session::carry_out(const request::Breakpoints& wanted) {
  breakpoints_.set(wanted.all);
  debug_.stopped_by.reset();
  breakpoints_due_ = true;
}

void Session::carry_out(const request::Span& wanted) {
  debug_.span = wanted.span;
  debug_.loop = wanted.loop && wanted.span;
  if (!debug_.span) return;
  FrameSpan& span = *debug_.span;
  if (span.first > span.last) std::swap(span.first, span.last);
  span.first = std::clamp(span.first, 0, source_->size() - 1);
  span.last = std::clamp(span.last, 0, source_->size() - 1);
}

void Session::carry_out(const request::Preview& wanted) {
  if (wanted.config) refuse_without_images(kNoOthers);
  if (wanted.config) refuse_out_of_range(*wanted.config);
  debug_.preview_config = wanted.config;
  // Until the new one is there, the last one is shown.
  if (!wanted.config) debug_.preview.reset();
  preview_due_ = motion_preview_due_ = wanted.config.has_value();
  preview_asked_ = std::chrono::steady_clock::now();
}

void Session::carry_out(const request::RunAll& wanted) {
  refuse_without_images(kNoOthers);
  refuse_out_of_range(wanted.config);
  wanted_ = std::max(wanted_, run_->track().processed());
  // What another program made cannot be run anew: it stands beside the run that takes its place.
  const bool was_outside = !run_->track().outside().empty();
  restart(wanted.config);
  if (was_outside) open_beside(options_.recorded);
  target_ = current_->index;
  show(target_);
}

void Session::carry_out(const request::AddGhost& wanted) {
  refuse_without_images(kNoOthers);
  refuse_out_of_range(wanted.config);
  if (const std::string why = why_no_masks(wanted.config, *source_); !why.empty()) throw InputError(why);
  if (wanted.waits && wanted.from >= run_->track().processed() && wanted.from < source_->size()) {
    debug_.waiting.push_back({wanted.name, wanted.config, wanted.from});
    wanted_ = std::max(wanted_, wanted.from + 1);
    return;
  }
  const int from = std::clamp(wanted.from, 0, std::max(0, run_->track().processed() - 1));
  Ghost ghost{.name = wanted.name,
              .run = std::make_unique<ShownRun>(*source_, frames_,
                                                run_->track().branch(from, wanted.config, run_->reader()))};
  compare(ghost);
  if (current_->index < ghost.run->track().processed()) ghost.current = current_;
  add(std::move(ghost));
  choose_others();
}

void Session::carry_out(const request::RemoveGhost& wanted) {
  if (wanted.index < 0 || wanted.index >= static_cast<int>(ghosts_.size()))
    throw InputError(fmt::format("there is no ghost run {}; there are {}", wanted.index, ghosts_.size()));
  ghosts_.erase(ghosts_.begin() + wanted.index);
}

void Session::write_beside(const std::string& folder, ExportJob::Work work) {
  if (!worker_.joinable()) {
    debug_.notice = work({});
    return;
  }
  (void)take_news();
  if (export_) throw InputError(fmt::format("{}: something else is still being written", folder));
  debug_.notice.clear();
  exporting_ = true;
  export_ = std::make_unique<ExportJob>(folder, std::move(work), [this] {
    const std::lock_guard lock(mutex_);
    news_ = true;
    asked_.notify_all();
  });
}

void Session::carry_out(const request::ExportFrames& wanted) {
  const FrameSpan span = debug_.span.value_or(FrameSpan{current_->index, current_->index});
  std::vector<int> frames;
  for (int frame = span.first; frame <= span.last; ++frame) frames.push_back(frame);
  write_beside(wanted.folder,
               [source = source_, frames, folder = wanted.folder](const ExportControl& control) {
                 return export_selection(*source, frames, folder, control);
               });
}

void Session::carry_out(const request::ExportSession& wanted) {
  refuse_without_images("Its frames cannot be handed on");
  const ReplayableRun& track = run_->track();
  const int frames = debug_.span ? std::min(debug_.span->last + 1, track.processed()) : track.processed();
  if (frames == 0) throw InputError(fmt::format("{}: no frame has been processed yet", wanted.folder));
  RunHash hash;
  for (int i = 0; i < frames; ++i) hash.add(track.records()[static_cast<std::size_t>(i)]);
  write_beside(wanted.folder, [source = source_, config = track.config(), frames, hash = hash.hex(),
                               marks = marks(), folder = wanted.folder](const ExportControl& control) {
    return export_session(
        {.source = *source, .config = config, .frames = frames, .run_hash = hash, .marks = marks}, folder,
        control);
  });
}

void Session::carry_out(const request::CheckSequence& /*wanted*/) {
  refuse_without_images("There is nothing to question");
  if (debug_.check.asking) return;
  const auto question = [this](const std::stop_token& stop) {
    CheckView view;
    try {
      const SequenceCheck check = check_sequence(*source_, stop);
      view = {.asking = false,
              .whole = true,
              .findings = check.findings,
              .times = to_lines(check.times, source_->camera())};
    } catch (const std::exception& error) {
      view.findings = {{"sequence", error.what()}};
    }
    return view;
  };
  if (!worker_.joinable()) {
    debug_.check = question({});
    return;
  }
  debug_.check.asking = true;
  checking_ = true;
  checker_ = std::jthread([this, question](const std::stop_token& stop) {
    CheckView view = question(stop);
    const std::lock_guard lock(mutex_);
    checked_ = std::move(view);
    news_ = true;
    asked_.notify_all();
  });
}

void Session::carry_out(const request::Sweep& wanted) {
  refuse_without_images("There is nothing to sweep over");
  refuse_out_of_range(wanted.base);
  if (sweeping_) throw InputError("another sweep still goes on");
  SweepView view{.range = wanted.range,
                 .values = sweep_values(wanted.base, wanted.range),
                 .points = {},
                 .frames = std::clamp(wanted.frames, 0, source_->size()),
                 .base = wanted.base,
                 .busy = true};
  // One thread: it gives way to what a person looks at meanwhile, and gives the same runs.
  view.base.run.threads = 1;
  const auto run = [this, view](const std::stop_token& stop) {
    const std::stop_callback ends(stop, [this] { stop_sweep_ = true; });
    std::string problem;
    try {
      for (const double value : view.values) {
        auto point = sweep_point(*source_, view.base, view.range.parameter, value, view.frames, &stop_sweep_);
        if (!point) break;
        const std::lock_guard lock(mutex_);
        swept_.push_back(std::move(*point));
        news_ = true;
        asked_.notify_all();
      }
    } catch (const std::exception& error) {
      problem = error.what();
    }
    const std::lock_guard lock(mutex_);
    sweep_problem_ = problem;
    sweeping_ = false;
    news_ = true;
    asked_.notify_all();
  };
  if (sweeper_.joinable()) sweeper_.join();
  (void)take_news();
  debug_.sweep = view;
  stop_sweep_ = false;
  sweeping_ = true;
  if (worker_.joinable()) {
    sweeper_ = std::jthread(run);
  } else {
    run({});
    (void)take_news();
  }
}

void Session::carry_out(const request::StopSweep& /*wanted*/) { stop_sweep_ = true; }

void Session::carry_out(const request::StopExport& /*wanted*/) {
  if (export_) export_->stop();
}

void Session::carry_out(const request::StagesBeside& wanted) {
  if (!wanted.method.empty()) (void)method_named(wanted.method);
  run_->lay_beside(wanted.method);
  beside_ = wanted.method;
  show(current_->index);
}

void Session::carry_out(const request::StandBeside& wanted) {
  debug_.other_is = wanted.which;
  if (wanted.keep) debug_.kept_frame = std::clamp(*wanted.keep, 0, source_->size() - 1);
  choose_others();
}

void Session::carry_out(const request::SavePreset& wanted) {
  refuse_out_of_range(wanted.config);
  write_text_file(wanted.file, to_toml(wanted.config));
  debug_.notice = fmt::format("preset written to {}", wanted.file);
}

}  // namespace stillpoint
