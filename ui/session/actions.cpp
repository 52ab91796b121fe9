#include "ui/session/actions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "core/inspect/frame_view.hpp"
#include "core/inspect/run_view.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {
namespace {

char lower(char letter) { return static_cast<char>(std::tolower(static_cast<unsigned char>(letter))); }

bool is_function_key(Key key) { return key >= Key::kF1 && key <= Key::kF12; }

template <typename Wanted>
std::optional<int> next_frame(const SessionView& session, Wanted wanted) {
  const FrameOutlines& frames = session.run->records.outlines();
  const auto last = std::min(static_cast<std::ptrdiff_t>(session.current->index) + 1,
                             static_cast<std::ptrdiff_t>(frames.size()));
  const auto found = std::find_if(frames.begin() + last, frames.end(), wanted);
  return found == frames.end() ? std::nullopt : std::optional(static_cast<int>(found - frames.begin()));
}

}  // namespace

void Actions::add(Action action) {
  if (find(action.name) != nullptr)
    throw std::logic_error(fmt::format("two actions are named {}", action.name));
  for (const KeyChord& chord : action.keys)
    for (const Action& other : actions_)
      if (std::find(other.keys.begin(), other.keys.end(), chord) != other.keys.end())
        throw std::logic_error(
            fmt::format("{} and {} have the key {}", action.name, other.name, to_string(chord)));
  actions_.push_back(std::move(action));
}

const Action* Actions::find(std::string_view name) const {
  const auto it =
      std::find_if(actions_.begin(), actions_.end(), [&](const Action& a) { return a.name == name; });
  return it == actions_.end() ? nullptr : &*it;
}

std::vector<std::string> Actions::groups() const {
  std::vector<std::string> groups;
  for (const Action& action : actions_)
    if (std::find(groups.begin(), groups.end(), action.group) == groups.end()) groups.push_back(action.group);
  return groups;
}

bool Actions::run(std::string_view name) const {
  const Action* action = find(name);
  if (action == nullptr || !is_enabled(*action)) return false;
  action->run();
  return true;
}

const Action* Actions::for_key(const KeyChord& chord) const {
  for (const Action& action : actions_)
    if (std::find(action.keys.begin(), action.keys.end(), chord) != action.keys.end())
      return is_enabled(action) ? &action : nullptr;
  return nullptr;
}

const Action* Actions::run_pressed_keys(bool typing) {
  for (const Action& action : actions_) {
    for (const KeyChord& chord : action.keys) {
      const bool commands = chord.modifiers.ctrl || chord.modifiers.alt || is_function_key(chord.key);
      if ((typing && !commands) || !is_chord_pressed(chord, action.repeats)) continue;
      // A key that is held until its way ends asked for nothing anew.
      if (!is_enabled(action)) return is_chord_pressed(chord) ? &action : nullptr;
      // A copy: what runs may change the actions there are.
      const auto run = action.run;
      held_ = !is_chord_pressed(chord);
      run();
      held_ = false;
      return nullptr;
    }
  }
  return nullptr;
}

bool is_enabled(const Action& action) { return !action.enabled || action.enabled(); }

std::string why_off(const Action& action) { return action.why_off ? action.why_off() : action.off; }

std::string key_text(const Action& action) {
  return action.keys.empty() ? "" : to_string(action.keys.front());
}

std::optional<int> match_score(std::string_view title, std::string_view query) {
  // Points: where a letter begins a word, or follows the last one found.
  constexpr int kWordStart = 8, kFollows = 4;
  int score = 0;
  std::size_t at = 0, last = std::string_view::npos;
  for (const char wanted : query) {
    if (wanted == ' ') continue;
    while (at < title.size() && lower(title[at]) != lower(wanted)) ++at;
    if (at == title.size()) return std::nullopt;
    if (at == 0 || title[at - 1] == ' ') score += kWordStart;
    if (last != std::string_view::npos && at == last + 1) score += kFollows;
    last = at++;
  }
  // Of titles that fit alike, the shorter says less else.
  return 100 * score - static_cast<int>(title.size());
}

std::optional<int> next_keyframe(const SessionView& session) {
  return next_frame(session, [](const FrameOutline& frame) { return frame.keyframe; });
}

std::optional<int> previous_keyframe(const SessionView& session) {
  const FrameOutlines& frames = session.run->records.outlines();
  auto at = frames.begin() + std::min(static_cast<std::ptrdiff_t>(session.current->index),
                                      static_cast<std::ptrdiff_t>(frames.size()));
  while (at != frames.begin())
    if ((--at)->keyframe) return static_cast<int>(at - frames.begin());
  return std::nullopt;
}

std::optional<int> next_lost_frame(const SessionView& session) {
  return next_frame(session, [](const FrameOutline& frame) { return is_lost(frame.status); });
}

}  // namespace stillpoint
