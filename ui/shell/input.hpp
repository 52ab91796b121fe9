#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace stillpoint {

// GCC takes a scoped enumerator for one that shadows the global kNone of the map.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wshadow"
/// Keys by name, whatever the window system and ImGui's version. Letters and digits by what they type on a US
/// layout.
enum class Key {
  kNone,
  k0,
  k1,
  k2,
  k3,
  k4,
  k5,
  k6,
  k7,
  k8,
  k9,
  kA,
  kB,
  kC,
  kD,
  kE,
  kF,
  kG,
  kH,
  kI,
  kJ,
  kK,
  kL,
  kM,
  kN,
  kO,
  kP,
  kQ,
  kR,
  kS,
  kT,
  kU,
  kV,
  kW,
  kX,
  kY,
  kZ,
  kF1,
  kF2,
  kF3,
  kF4,
  kF5,
  kF6,
  kF7,
  kF8,
  kF9,
  kF10,
  kF11,
  kF12,
  kSpace,
  kEnter,
  kKeypadEnter,
  kEscape,
  kTab,
  kBackspace,
  kDelete,
  kInsert,
  kLeft,
  kRight,
  kUp,
  kDown,
  kHome,
  kEnd,
  kPageUp,
  kPageDown,
  kMinus,
  kEqual,
  kComma,
  kPeriod,
  kSlash,
  kSemicolon,
  kApostrophe,
  kGrave,
  kLeftBracket,
  kRightBracket,
  kBackslash,
  kCount
};
#pragma GCC diagnostic pop

/// Modifier keys held.
struct Modifiers {
  bool ctrl = false, shift = false, alt = false, super = false;
  bool operator==(const Modifiers&) const = default;
};

inline constexpr Modifiers kCtrl{.ctrl = true}, kShift{.shift = true};

/// A key with its modifiers, as shortcuts are written: "Ctrl+Shift+P", "Space", "[".
struct KeyChord {
  Key key = Key::kNone;
  Modifiers modifiers;
  bool operator==(const KeyChord&) const = default;
};

/// The name a key is printed by: "A", "F5", "Left", "[".
[[nodiscard]] std::string_view key_name(Key key);

/// A chord as people read it, and back. Parsing takes any case and gives nothing for what is no chord.
[[nodiscard]] std::string to_string(const KeyChord& chord);
[[nodiscard]] std::optional<KeyChord> parse_key_chord(std::string_view text);

// What a person does, one event each. A window makes them from its system's events; a recording or a test
// makes them itself; both pass through one InputQueue. Positions are framebuffer pixels, origin top left.
struct MouseMoved {
  float x = 0.0F, y = 0.0F;  ///< px
};
/// The mouse has left what it was over.
inline constexpr MouseMoved kMouseNowhere{-1e5F, -1e5F};
struct MouseButton {
  int button = 0;  ///< 0 left, 1 right, 2 middle
  bool down = false;
  Modifiers modifiers;
};
struct MouseWheel {
  float dx = 0.0F, dy = 0.0F;  ///< notches; up is positive
  Modifiers modifiers;
};
struct KeyChanged {
  Key key = Key::kNone;
  bool down = false;
  Modifiers modifiers;
};
struct TextTyped {
  unsigned codepoint = 0;  ///< Unicode
};
struct FocusChanged {
  bool focused = true;
};
struct FilesDropped {
  std::vector<std::string> paths;
};
using InputEvent =
    std::variant<MouseMoved, MouseButton, MouseWheel, KeyChanged, TextTyped, FocusChanged, FilesDropped>;

/// Events on their way to the interface, which sees one state a frame: a press and its release between
/// two frames must reach it in two frames, or the click is lost.
class InputQueue {
 public:
  void push(InputEvent event) { events_.push_back(std::move(event)); }
  [[nodiscard]] bool empty() const { return events_.empty(); }

  /// The events the next frame takes: up to the first that would hide another of the same frame.
  [[nodiscard]] std::vector<InputEvent> next_frame();

 private:
  std::deque<InputEvent> events_;
};

/// Tells ImGui's current context how Key maps to it; once a context.
void set_up_imgui_keys();

/// Hands one event to ImGui's current context. Dropped files are not ImGui's and pass by.
void apply_to_imgui(const InputEvent& event);

/// Whether the key went down in this frame (or repeats, where asked), or is held; in the current ImGui
/// context.
[[nodiscard]] bool is_key_pressed(Key key, bool repeat = false);
[[nodiscard]] bool is_key_down(Key key);

/// Whether exactly this chord was pressed in this frame.
[[nodiscard]] bool is_chord_pressed(const KeyChord& chord, bool repeat = false);

}  // namespace stillpoint
