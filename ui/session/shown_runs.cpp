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

std::string why_no_pictures(const SessionView& session, const GhostView& ghost) {
  const int index = session.current->index;
  if (ghost.current == nullptr || ghost.current->index != index)
    return fmt::format("{} has not come to frame {} yet.", ghost.name, index);
  const bool bare = ghost.current->mask.empty() &&
                    (ghost.current->record == nullptr || ghost.current->record->features.empty());
  if (ghost.outside && bare)
    return fmt::format("{} is another program's trajectory: it has no pictures.", ghost.name);
  return {};
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

}  // namespace

std::vector<ListedRun> listed_runs(const SessionView& session) {
  using Kind = ListedRun::Kind;
  std::vector<ListedRun> runs{{.name = session.run->name,
                               .kind = Kind::own,
                               .ghost = 0,
                               .look = 0,
                               .run = session.run,
                               .current = session.current,
                               .no_pictures = {}}};
  if (session.baseline) {
    const std::string name = unlike_others(runs, "baseline " + session.baseline->name);
    runs.push_back({.name = name,
                    .kind = Kind::baseline,
                    .ghost = 0,
                    .look = 0,
                    .run = session.baseline,
                    .current = nullptr,
                    .no_pictures = fmt::format("The baseline {0} keeps its figures alone. \"Compare with "
                                               "method {0}\" lays a run beside that has pictures.",
                                               session.baseline->name)});
  }
  for (std::size_t i = 0; i < session.debug.ghosts.size(); ++i) {
    const GhostView& ghost = session.debug.ghosts[i];
    runs.push_back({.name = unlike_others(runs, ghost.name),
                    .kind = Kind::ghost,
                    .ghost = i,
                    .look = ghost.look.value_or(i),
                    .run = ghost.run,
                    .current = ghost.current,
                    .no_pictures = why_no_pictures(session, ghost)});
  }
  return runs;
}

std::vector<ListedRun> RunsShown::chosen_of(const SessionView& session) const {
  std::vector<ListedRun> runs = listed_runs(session);
  std::erase_if(runs, [&](const ListedRun& run) {
    if (chosen.empty())
      // A ghost that is still on its way is worth waiting for; what never has a picture is not.
      return run.kind == ListedRun::Kind::baseline ||
             (run.kind == ListedRun::Kind::ghost && session.debug.ghosts[run.ghost].outside &&
              !run.no_pictures.empty());
    return std::find(chosen.begin(), chosen.end(), run.name) == chosen.end();
  });
  return runs;
}

void RunsShown::toggle(const SessionView& session, const std::string& name) {
  // Those seen so far are the ones a person takes from or adds to.
  if (chosen.empty()) chosen = names_of(chosen_of(session));
  if (std::erase(chosen, name) == 0) chosen.push_back(name);
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

bool RunsShown::hides(const std::string& name) const {
  return std::find(hidden.begin(), hidden.end(), name) != hidden.end();
}

void RunsShown::toggle_hidden(const std::string& name) {
  if (std::erase(hidden, name) == 0) hidden.push_back(name);
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
    if (run.kind == ListedRun::Kind::baseline && shown.hides(run.name)) other.baseline = nullptr;
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
  other.config = run.kind == ListedRun::Kind::ghost ? session.debug.ghosts[run.ghost].config : session.config;
  other.own_run = run.kind == ListedRun::Kind::own;
  other.frame_count = session.frame_count;
  other.processed = static_cast<int>(run.run->records.size());
  other.playing = session.playing;
  other.busy = session.busy;
  other.current = run.current;
  other.run = run.run;
  other.revision = session.revision;
  other.debug.pins = session.debug.pins;
  return other;
}

}  // namespace stillpoint
