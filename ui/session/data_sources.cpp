#include "ui/session/data_sources.hpp"

#include <algorithm>

#include "core/run/removal_errors.hpp"

namespace stillpoint {

std::optional<int> next_worst(const std::vector<int>& worst, int frame, std::optional<int> gone_to) {
  auto next = worst.begin();
  if (gone_to == frame)
    if (const auto at = std::find(worst.begin(), worst.end(), frame); at != worst.end()) next = at + 1;
  if (next != worst.end() && *next == frame) ++next;  // the worst is shown already
  return next == worst.end() ? std::nullopt : std::optional(*next);
}

std::optional<int> previous_worst(const std::vector<int>& worst, int frame, std::optional<int> gone_to) {
  if (gone_to != frame) return std::nullopt;
  const auto at = std::find(worst.begin(), worst.end(), frame);
  return at == worst.end() || at == worst.begin() ? std::nullopt : std::optional(*(at - 1));
}

std::vector<int> hit_frames(const DebugView& debug) {
  std::vector<int> frames;
  for (const BreakpointView& one : debug.breakpoints)
    if (one.breakpoint.enabled) frames.insert(frames.end(), one.hits.begin(), one.hits.end());
  std::sort(frames.begin(), frames.end());
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

std::vector<int> hurt_frames(const DebugView& debug) {
  std::vector<int> frames;
  for (const RemovalError& one : *debug.removal)
    if (one.hurt) frames.push_back(one.frame);
  return frames;
}

std::vector<int> bookmarked_frames(const DebugView& debug) {
  std::vector<int> frames;
  for (const Bookmark& one : debug.bookmarks) frames.push_back(one.frame);
  return frames;
}

std::optional<int> next_in(const std::vector<int>& frames, int frame) {
  const auto at = std::upper_bound(frames.begin(), frames.end(), frame);
  return at == frames.end() ? std::nullopt : std::optional(*at);
}

std::optional<int> previous_in(const std::vector<int>& frames, int frame) {
  const auto at = std::lower_bound(frames.begin(), frames.end(), frame);
  return at == frames.begin() ? std::nullopt : std::optional(*(at - 1));
}

std::optional<int> first_divergence(const DebugView& debug) {
  std::optional<int> first;
  for (const GhostView& ghost : debug.ghosts)
    if (ghost.diverged && (!first || *ghost.diverged < *first)) first = ghost.diverged;
  return first;
}

std::vector<Bookmark> with_bookmark(std::vector<Bookmark> all, int frame) {
  const auto at = std::lower_bound(all.begin(), all.end(), frame,
                                   [](const Bookmark& one, int index) { return one.frame < index; });
  if (at == all.end() || at->frame != frame) all.insert(at, {frame, ""});
  return all;
}

std::vector<Bookmark> without_bookmark(std::vector<Bookmark> all, int frame) {
  std::erase_if(all, [frame](const Bookmark& one) { return one.frame == frame; });
  return all;
}

const Bookmark* bookmark_at(const DebugView& debug, int frame) {
  for (const Bookmark& one : debug.bookmarks)
    if (one.frame == frame) return &one;
  return nullptr;
}

std::vector<Breakpoint> breakpoints_of(const DebugView& debug) {
  std::vector<Breakpoint> all;
  for (const BreakpointView& one : debug.breakpoints) all.push_back(one.breakpoint);
  return all;
}

FrameSpan span_between(int a, int b, int frame_count) {
  const int last = std::max(0, frame_count - 1);
  return {std::clamp(std::min(a, b), 0, last), std::clamp(std::max(a, b), 0, last)};
}

}  // namespace stillpoint
