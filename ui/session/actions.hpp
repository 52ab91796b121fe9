#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ui/session/session_view.hpp"
#include "ui/shell/input.hpp"

namespace stillpoint {

/// Something a person can have done, by whatever way: menu, key, palette, button, test.
struct Action {
  std::string name;   ///< "step_back": for settings and tests
  std::string title;  ///< "Step back"
  std::string group;  ///< the menu it stands in
  std::string icon{};
  std::vector<KeyChord> keys{};            ///< the first is printed
  bool repeats = false;                    ///< while its key is held
  std::function<bool()> enabled{};         ///< always, when empty
  std::string off{};                       ///< why it is not, for people: "No frame after this one is lost."
  std::function<std::string()> why_off{};  ///< the same where it depends
  std::function<bool()> checked{};         ///< whether it is on, for what is switched
  std::function<void()> run;
};

/// All actions, in the order of menus.
class Actions {
 public:
  /// @throws std::logic_error for a name or a key that another action has
  void add(Action action);

  [[nodiscard]] const std::vector<Action>& all() const { return actions_; }
  [[nodiscard]] const Action* find(std::string_view name) const;
  [[nodiscard]] std::vector<std::string> groups() const;  ///< in order of first appearance

  /// Runs it when it is enabled. @returns whether it was run
  bool run(std::string_view name) const;

  /// The action of a key, when it is enabled.
  [[nodiscard]] const Action* for_key(const KeyChord& chord) const;

  /// Runs what the keys pressed in ImGui's current frame stand for.
  /// @param typing a text field has the keys: only those with Ctrl or Alt, and function keys, count
  /// @returns the action whose key was struck and that is not enabled now; null where there is none
  const Action* run_pressed_keys(bool typing);
  /// Whether what runs now does so for a key that was pressed before and is held.
  [[nodiscard]] bool key_is_held() const { return held_; }

 private:
  std::vector<Action> actions_;
  bool held_ = false;
};

[[nodiscard]] bool is_enabled(const Action& action);

/// Why it is not enabled; empty where it does not tell.
[[nodiscard]] std::string why_off(const Action& action);

/// The key printed beside an action; empty when it has none.
[[nodiscard]] std::string key_text(const Action& action);

/// How well `query` fits `title`: its letters must occur in order, whatever their case. Higher is better;
/// nothing when it does not fit.
[[nodiscard]] std::optional<int> match_score(std::string_view title, std::string_view query);

// Where to go from the frame shown, among those processed.
[[nodiscard]] std::optional<int> next_keyframe(const SessionView& session);
[[nodiscard]] std::optional<int> previous_keyframe(const SessionView& session);
[[nodiscard]] std::optional<int> next_lost_frame(const SessionView& session);

}  // namespace stillpoint
