#pragma once

#include <map>
#include <optional>
#include <string>

namespace stillpoint {

/// What is chosen in one panel's controls, by the words they show: "Map points" is "off". Layouts keep it and
/// bring it back.
class PanelChoices {
 public:
  using Words = std::map<std::string, std::string>;

  /// Has controls take these values when they are drawn next.
  void want(Words wanted) { wanted_ = std::move(wanted); }

  /// Told by a control that has no such value.
  void refuse(const std::string& control, const std::string& value) { refused_[control] = value; }

  /// What was wanted and no control drawn so far could take.
  [[nodiscard]] Words left() const {
    Words words = wanted_;
    words.insert(refused_.begin(), refused_.end());
    return words;
  }

  /// Told by a control before it is drawn. @returns the value it is to take instead of `now`, if any
  std::optional<std::string> take(const std::string& control, const std::string& now) {
    first_.emplace(control, now);
    const auto wanted = wanted_.find(control);
    if (wanted == wanted_.end()) return std::nullopt;
    std::string value = std::move(wanted->second);
    wanted_.erase(wanted);
    return value;
  }

  /// What every control said last: for another panel of its kind, which is to show the same of another run.
  [[nodiscard]] PanelChoices mirrored() const {
    PanelChoices mirror;
    mirror.wanted_ = now_;
    mirror.wanted_.insert(passing_.begin(), passing_.end());
    mirror.mirrors_ = true;
    return mirror;
  }
  /// Whether what a frame's own controls say is taken too, not a person's choices alone.
  [[nodiscard]] bool mirrors() const { return mirrors_; }
  /// Told by a control whose choice is a matter of the frame and is not kept.
  void note_passing(const std::string& control, const std::string& now) { passing_[control] = now; }

  /// Told by a control after it was drawn.
  void note(const std::string& control, const std::string& now) { now_[control] = now; }

  /// What is not as the panel itself has it, and what is still wanted.
  [[nodiscard]] Words changed() const {
    Words words = wanted_;
    for (const auto& [control, value] : now_)
      if (const auto first = first_.find(control); first != first_.end() && first->second != value)
        words[control] = value;
    return words;
  }

 private:
  Words wanted_, refused_, first_, now_, passing_;
  bool mirrors_ = false;
};

}  // namespace stillpoint
