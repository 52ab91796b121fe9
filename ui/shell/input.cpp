#include "ui/shell/input.hpp"

#include <array>
#include <cctype>

namespace stillpoint {
namespace {

constexpr std::array<std::string_view, static_cast<std::size_t>(Key::kCount)> kKeyNames = {
    "None",     "0",     "1",         "2",
    "3",        "4",     "5",         "6",
    "7",        "8",     "9",         "A",
    "B",        "C",     "D",         "E",
    "F",        "G",     "H",         "I",
    "J",        "K",     "L",         "M",
    "N",        "O",     "P",         "Q",
    "R",        "S",     "T",         "U",
    "V",        "W",     "X",         "Y",
    "Z",        "F1",    "F2",        "F3",
    "F4",       "F5",    "F6",        "F7",
    "F8",       "F9",    "F10",       "F11",
    "F12",      "Space", "Enter",     "Keypad Enter",
    "Esc",      "Tab",   "Backspace", "Delete",
    "Insert",   "Left",  "Right",     "Up",
    "Down",     "Home",  "End",       "PageUp",
    "PageDown", "-",     "=",         ",",
    ".",        "/",     ";",         "'",
    "`",        "[",     "]",         "\\"};

bool equal_ignoring_case(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::tolower(static_cast<unsigned char>(a[i])) != std::tolower(static_cast<unsigned char>(b[i])))
      return false;
  }
  return true;
}

/// Whether two events of one frame would leave only the later one visible, or change its place.
bool hides(const InputEvent& earlier, const InputEvent& later) {
  if (const auto* button = std::get_if<MouseButton>(&earlier)) {
    if (const auto* other = std::get_if<MouseButton>(&later)) return button->button == other->button;
    return std::holds_alternative<MouseMoved>(later) || std::holds_alternative<MouseWheel>(later);
  }
  if (std::holds_alternative<MouseWheel>(earlier)) {
    return std::holds_alternative<MouseMoved>(later) || std::holds_alternative<MouseButton>(later);
  }
  if (const auto* key = std::get_if<KeyChanged>(&earlier)) {
    const auto* other = std::get_if<KeyChanged>(&later);
    return other != nullptr && (key->key == other->key || key->modifiers != other->modifiers);
  }
  return false;
}

}  // namespace

std::string_view key_name(Key key) { return kKeyNames.at(static_cast<std::size_t>(key)); }

std::string to_string(const KeyChord& chord) {
  std::string text;
  if (chord.modifiers.ctrl) text += "Ctrl+";
  if (chord.modifiers.shift) text += "Shift+";
  if (chord.modifiers.alt) text += "Alt+";
  if (chord.modifiers.super) text += "Super+";
  return text.append(key_name(chord.key));
}

std::optional<KeyChord> parse_key_chord(std::string_view text) {
  KeyChord chord;
  for (std::size_t plus = text.find('+'); plus != std::string_view::npos; plus = text.find('+')) {
    const std::string_view modifier = text.substr(0, plus);
    if (equal_ignoring_case(modifier, "Ctrl"))
      chord.modifiers.ctrl = true;
    else if (equal_ignoring_case(modifier, "Shift"))
      chord.modifiers.shift = true;
    else if (equal_ignoring_case(modifier, "Alt"))
      chord.modifiers.alt = true;
    else if (equal_ignoring_case(modifier, "Super"))
      chord.modifiers.super = true;
    else
      return std::nullopt;
    text.remove_prefix(plus + 1);
  }
  for (std::size_t i = 1; i < kKeyNames.size(); ++i) {
    if (!equal_ignoring_case(kKeyNames[i], text)) continue;
    chord.key = static_cast<Key>(i);
    return chord;
  }
  return std::nullopt;
}

std::vector<InputEvent> InputQueue::next_frame() {
  std::vector<InputEvent> taken;
  while (!events_.empty()) {
    for (const InputEvent& earlier : taken) {
      if (hides(earlier, events_.front())) return taken;
    }
    taken.push_back(std::move(events_.front()));
    events_.pop_front();
  }
  return taken;
}

}  // namespace stillpoint
