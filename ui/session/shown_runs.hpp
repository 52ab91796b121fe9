#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ui/session/session_view.hpp"

namespace stillpoint {

// The runs that stand beside each other in a session as one list, and which of them pictures show. No ImGui.

/// A run of the session: its own, the baseline, a ghost, a finished one or another program's.
struct ListedRun {
  enum class Kind { own, baseline, ghost };
  std::string name;  ///< as panels write it, no two alike
  Kind kind = Kind::own;
  std::size_t ghost = 0;                     ///< index into DebugView::ghosts
  std::size_t look = 0;                      ///< … and which of the looks of ghosts it has
  std::shared_ptr<const RunView> run;        ///< never null
  std::shared_ptr<const FrameView> current;  ///< its view of the frame shown; null where it has none
  std::shared_ptr<const FrameView> other;    ///< … and of the frame that stands beside it (Two frames)
  std::string no_pictures;                   ///< why its pictures cannot be shown; empty where they can
  bool never_has_pictures = false;           ///< … and of no other frame either
};

/// The session's own run first, then the baseline and the ghosts in their order.
[[nodiscard]] std::vector<ListedRun> listed_runs(const SessionView& session);

/// What pictures of the frame are of.
enum class RunPictures {
  alone,    ///< the session's own run
  wiped,    ///< several runs, each in a strip of one picture
  flipped,  ///< one run after the other, in place
};

/// Which runs pictures show, and how. Runs are kept by name: one that is not open is passed over.
struct RunsShown {
  RunPictures pictures = RunPictures::alone;
  std::vector<std::string> only{};    ///< these and no others, as a command names them; empty: what follows
  std::vector<std::string> ticked{};  ///< by hand
  std::vector<std::string>
      left_out{};                     ///< by hand; what is in neither list is shown once it can have pictures
  std::string flipped_to{};           ///< the run seen while pictures flip; empty: the first one chosen
  std::vector<std::string> hidden{};  ///< runs that plots, tables and the trajectory leave out
  std::vector<float> dividers{};      ///< ascending shares of a picture's width, one fewer than strips
  bool operator==(const RunsShown&) const = default;

  /// Of the runs open, those chosen, in their list's order.
  [[nodiscard]] std::vector<ListedRun> chosen_of(const SessionView& session) const;
  /// Why there is nothing to set against anything, and what to do about it, one sentence; empty where there
  /// is.
  [[nodiscard]] std::string why_not_several(const SessionView& session) const;
  /// Whether pictures of the baseline are shown, or are next (SessionView::baseline_frame).
  [[nodiscard]] bool wants_baseline(const SessionView& session) const;
  /// Takes a run among those chosen, or out.
  void toggle(const SessionView& session, const std::string& name);
  /// Begins to flip, or goes on to the next run chosen; by -1 to the one before.
  void flip(const SessionView& session, int by);
  /// The run that pictures show in place of the session's own; nothing while they do not flip.
  [[nodiscard]] std::optional<ListedRun> flipped(const SessionView& session) const;
  [[nodiscard]] bool hides(const std::string& name) const;
  /// Leaves a run out of plots, tables and the trajectory, or has it there again.
  void toggle_hidden(const std::string& name);
  /// A run was removed: another of its name is a new one.
  void forget(const std::string& name);
  /// Dividers for so many strips: those there are, or equal strips where there are others.
  void fit_dividers(std::size_t strips);
};

/// "wipe" and the like, for settings and the command line.
[[nodiscard]] std::string to_string(RunPictures pictures);
/// @returns alone for a word that is none
[[nodiscard]] RunPictures run_pictures(const std::string& word);

/// The session without the runs that are hidden; the session's own always stays.
[[nodiscard]] SessionView without_hidden(const SessionView& session, const RunsShown& shown);

/// What panels of the frame shown draw for another run: the session with that run in place of its own. What
/// pictures have no use for (map points, keyframes, ghosts) is left out.
/// @pre run.no_pictures is empty
[[nodiscard]] SessionView as_run(const SessionView& session, const ListedRun& run);

}  // namespace stillpoint
