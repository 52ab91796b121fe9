#include "core/inspect/breakpoint_set.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace stillpoint {

void BreakpointSet::set(const std::vector<Breakpoint>& all) {
  views_.clear();
  conditions_.clear();
  for (const Breakpoint& breakpoint : all) {
    views_.push_back({.breakpoint = breakpoint, .error = {}, .error_column = 0, .hits = {}});
    conditions_.emplace_back();
    try {
      conditions_.back().emplace(breakpoint.expression);
    } catch (const ConditionError& error) {
      views_.back().error = error.what();
      views_.back().error_column = error.column();
    }
  }
}

std::set<int> BreakpointSet::figures() const {
  std::set<int> all;
  for (const std::optional<Condition>& condition : conditions_)
    if (condition) all.insert(condition->figures().begin(), condition->figures().end());
  return all;
}

void BreakpointSet::update(const FrameFigures& figures) {
  for (std::size_t i = 0; i < views_.size(); ++i)
    if (conditions_[i]) {
      views_[i].hits = conditions_[i]->frames(figures);
      const auto unknown = conditions_[i]->unknown_figures(figures);
      views_[i].note = unknown.empty() ? "" : fmt::format("no frame so far has {}", fmt::join(unknown, ", "));
    }
}

std::optional<int> BreakpointSet::stopping_at(int frame) const {
  for (std::size_t i = 0; i < views_.size(); ++i)
    if (views_[i].breakpoint.enabled &&
        std::binary_search(views_[i].hits.begin(), views_[i].hits.end(), frame))
      return static_cast<int>(i);
  return std::nullopt;
}

std::vector<Breakpoint> BreakpointSet::breakpoints() const {
  std::vector<Breakpoint> all;
  for (const BreakpointView& view : views_) all.push_back(view.breakpoint);
  return all;
}

}  // namespace stillpoint
