#pragma once

#include <optional>
#include <set>
#include <vector>

#include "core/inspect/marks.hpp"
#include "core/run/condition.hpp"

namespace stillpoint {

/// The breakpoints of a session, read once, and where they hold.
class BreakpointSet {
 public:
  /// Replaces all. One that cannot be read is kept and says why.
  void set(const std::vector<Breakpoint>& all);

  /// Finds the frames at which each holds, those switched off too.
  void update(const FrameFigures& figures);
  /// What their conditions are made of, indices into frame_figure_infos(): all that update() asks for.
  [[nodiscard]] std::set<int> figures() const;

  /// The first that is switched on and holds at a frame, as far as update() has seen it.
  [[nodiscard]] std::optional<int> stopping_at(int frame) const;

  [[nodiscard]] bool empty() const { return views_.empty(); }
  [[nodiscard]] const std::vector<BreakpointView>& views() const { return views_; }
  [[nodiscard]] std::vector<Breakpoint> breakpoints() const;

 private:
  std::vector<BreakpointView> views_;
  std::vector<std::optional<Condition>> conditions_;  // one a view; nothing where it cannot be read
};

}  // namespace stillpoint
