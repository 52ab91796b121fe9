#include "ui/session/shown_runs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/check/findings.hpp"
#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/run/removal_errors.hpp"
#include "core/run/saved_map.hpp"
#include "core/run/sweep.hpp"

namespace stillpoint {
namespace {

/// Whether there is nothing of a frame but where the camera was.
bool is_bare(const FrameView& view) {
  return view.mask.empty() && (view.record == nullptr || view.record->features.empty());
}

/// Says why pictures of a run cannot be shown, where they cannot.
void tell_pictures(const SessionView& session, bool outside, ListedRun& run) {
  const int index = session.current->index;
  const auto& records = run.run->records;
  const std::shared_ptr<const FrameView>& view = run.current;
  const bool there = view != nullptr && view->index == index;
  if (outside && (!there || is_bare(*view)))
    run.never_has_pictures = std::none_of(records.begin(), records.end(), [](const FrameRecord& record) {
      return record.measured.mask || record.measured.features;
    });
  if (run.never_has_pictures)
    run.no_pictures = fmt::format("{} is another program's trajectory: it has no pictures.", run.name);
  else if (!there)
    run.no_pictures = fmt::format("{} has not come to frame {} yet.", run.name, index);
  else if (outside && is_bare(*view))
    run.no_pictures = fmt::format("{} left neither mask nor features of frame {}.", run.name, index);
}

/// A name that none of those before has.
std::string unlike_others(const std::vector<ListedRun>& others, const std::string& name) {
  const auto taken = [&](const std::string& candidate) {
    return std::any_of(others.begin(), others.end(),
                       [&](const ListedRun& run) { return run.name == candidate; });
  };
  std::string candidate = name;
  for (int number = 2; taken(candidate); ++number) candidate = fmt::format("{} ({})", name, number);
  return candidate;
}

std::vector<std::string> names_of(const std::vector<ListedRun>& runs) {
  std::vector<std::string> names;
  for (const ListedRun& run : runs) names.push_back(run.name);
  return names;
}

bool is_in(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::vector<ListedRun> listed_runs(const SessionView& session) {
  using Kind = ListedRun::Kind;
  std::vector<ListedRun> runs{{.name = session.run->name,
                               .kind = Kind::own,
                               .ghost = 0,
                               .look = 0,
                               .run = session.run,
                               .current = session.current,
                               .other = session.debug.other,
                               .no_pictures = {}}};
  if (session.baseline) {
    runs.push_back({.name = unlike_others(runs, baseline_name(session)),
                    .kind = Kind::baseline,
                    .ghost = 0,
                    .look = 0,
                    .run = session.baseline,
                    .current = session.baseline_frame.current,
                    .other = session.baseline_frame.other,
                    .no_pictures = {}});
    tell_pictures(session, false, runs.back());
  }
  for (std::size_t i = 0; i < session.debug.ghosts.size(); ++i) {
    const GhostView& ghost = session.debug.ghosts[i];
    runs.push_back({.name = unlike_others(runs, ghost.name),
                    .kind = Kind::ghost,
                    .ghost = i,
                    .look = ghost.look.value_or(i),
                    .run = ghost.run,
                    .current = ghost.current,
                    .other = ghost.other,
                    .no_pictures = {}});
    tell_pictures(session, ghost.outside, runs.back());
  }
  return runs;
}

std::vector<ListedRun> RunsShown::chosen_of(const SessionView& session) const {
  std::vector<ListedRun> runs = listed_runs(session);
  std::erase_if(runs, [&](const ListedRun& run) {
    if (!only.empty()) return !is_in(only, run.name);
    if (is_in(left_out, run.name)) return true;
    // A run that is still on its way is worth waiting for; what never has a picture is not.
    return run.never_has_pictures && !is_in(ticked, run.name);
  });
  return runs;
}

std::string RunsShown::why_not_several(const SessionView& session) const {
  const std::vector<ListedRun> chosen = chosen_of(session), all = listed_runs(session);
  if (chosen.size() > 1) return {};
  constexpr const char* kAdd = "\"Compare with method …\" in the palette (Ctrl+Shift+P) adds one.";
  if (all.size() < 2) return fmt::format("There is no second run: {}", kAdd);
  const auto have =
      std::count_if(all.begin(), all.end(), [](const ListedRun& run) { return !run.never_has_pictures; });
  if (have < 2) return fmt::format("No second run has pictures: {}", kAdd);
  return chosen.empty() ? "No run is ticked: tick two in Compare runs."
                        : fmt::format("Only {} is ticked: tick another run in Compare runs.", chosen[0].name);
}

bool RunsShown::wants_baseline(const SessionView& session) const {
  if (pictures == RunPictures::alone || !session.baseline) return false;
  const std::vector<ListedRun> chosen = chosen_of(session);
  return std::any_of(chosen.begin(), chosen.end(),
                     [](const ListedRun& run) { return run.kind == ListedRun::Kind::baseline; });
}

void RunsShown::toggle(const SessionView& session, const std::string& name) {
  const bool was = is_in(names_of(chosen_of(session)), name);
  if (!only.empty()) {
    for (const ListedRun& run : listed_runs(session))
      if (!is_in(only, run.name)) left_out.push_back(run.name);
    only.clear();
  }
  std::erase(ticked, name);
  std::erase(left_out, name);
  (was ? left_out : ticked).push_back(name);
}

void RunsShown::flip(const SessionView& session, int by) {
  const std::vector<std::string> names = names_of(chosen_of(session));
  if (names.empty()) return;
  const auto count = static_cast<int>(names.size());
  const auto found = std::find(names.begin(), names.end(), flipped_to);
  int at = found == names.end() ? 0 : static_cast<int>(found - names.begin());
  // The first press already shows another run than the one that is seen.
  if (pictures != RunPictures::flipped) at = 0;
  pictures = RunPictures::flipped;
  flipped_to = names[static_cast<std::size_t>((at + by + count) % count)];
}

std::optional<ListedRun> RunsShown::flipped(const SessionView& session) const {
  if (pictures != RunPictures::flipped) return std::nullopt;
  const std::vector<ListedRun> runs = chosen_of(session);
  for (const ListedRun& run : runs)
    if (run.name == flipped_to) return run;
  return runs.empty() ? std::nullopt : std::optional(runs.front());
}

bool RunsShown::hides(const std::string& name) const { return is_in(hidden, name); }

void RunsShown::toggle_hidden(const std::string& name) {
  if (std::erase(hidden, name) == 0) hidden.push_back(name);
}

void RunsShown::forget(const std::string& name) {
  for (std::vector<std::string>* names : {&only, &ticked, &left_out, &hidden}) std::erase(*names, name);
}

void RunsShown::fit_dividers(std::size_t strips) {
  if (strips == 0 || dividers.size() + 1 == strips) return;
  dividers.clear();
  for (std::size_t i = 1; i < strips; ++i)
    dividers.push_back(static_cast<float>(i) / static_cast<float>(strips));
}

std::string to_string(RunPictures pictures) {
  switch (pictures) {
    case RunPictures::wiped:
      return "wipe";
    case RunPictures::flipped:
      return "flip";
    case RunPictures::alone:
      break;
  }
  return "alone";
}

RunPictures run_pictures(const std::string& word) {
  for (const RunPictures pictures : {RunPictures::wiped, RunPictures::flipped})
    if (to_string(pictures) == word) return pictures;
  return RunPictures::alone;
}

SessionView without_hidden(const SessionView& session, const RunsShown& shown) {
  SessionView other = session;
  other.debug.ghosts.clear();
  for (const ListedRun& run : listed_runs(session)) {
    if (run.kind == ListedRun::Kind::baseline && shown.hides(run.name)) {
      other.baseline = nullptr;
      other.baseline_frame = {};
    }
    if (run.kind != ListedRun::Kind::ghost || shown.hides(run.name)) continue;
    other.debug.ghosts.push_back(session.debug.ghosts[run.ghost]);
    // Those that are left keep their colours and names.
    other.debug.ghosts.back().look = run.look;
  }
  return other;
}

SessionView as_run(const SessionView& session, const ListedRun& run) {
  SessionView other;
  other.title = session.title;
  other.camera = session.camera;
  switch (run.kind) {
    case ListedRun::Kind::own:
      other.config = session.config;
      other.outside = session.outside;
      break;
    case ListedRun::Kind::baseline:
      other.config = session.baseline_config;
      break;
    case ListedRun::Kind::ghost:
      other.config = session.debug.ghosts[run.ghost].config;
      if (session.debug.ghosts[run.ghost].outside) other.outside = run.name;
      break;
  }
  other.own_run = run.kind == ListedRun::Kind::own;
  other.frame_count = session.frame_count;
  other.processed = static_cast<int>(run.run->records.size());
  other.playing = session.playing;
  other.busy = session.busy;
  other.current = run.current;
  other.run = run.run;
  other.revision = session.revision;
  other.debug.pins = session.debug.pins;
  other.debug.other_is = session.debug.other_is;
  other.debug.kept_frame = session.debug.kept_frame;
  other.debug.other = run.other;
  return other;
}

}  // namespace stillpoint
