#include "ui/shell/window_input.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace stillpoint {
namespace {

Key offset_key(Key first, int by) { return static_cast<Key>(static_cast<int>(first) + by); }

}  // namespace

Key key_from_glfw(int glfw_key) {
  if (glfw_key >= GLFW_KEY_0 && glfw_key <= GLFW_KEY_9) return offset_key(Key::k0, glfw_key - GLFW_KEY_0);
  if (glfw_key >= GLFW_KEY_KP_0 && glfw_key <= GLFW_KEY_KP_9)
    return offset_key(Key::k0, glfw_key - GLFW_KEY_KP_0);
  if (glfw_key >= GLFW_KEY_A && glfw_key <= GLFW_KEY_Z) return offset_key(Key::kA, glfw_key - GLFW_KEY_A);
  if (glfw_key >= GLFW_KEY_F1 && glfw_key <= GLFW_KEY_F12)
    return offset_key(Key::kF1, glfw_key - GLFW_KEY_F1);
  switch (glfw_key) {
    case GLFW_KEY_SPACE:
      return Key::kSpace;
    case GLFW_KEY_ENTER:
      return Key::kEnter;
    case GLFW_KEY_KP_ENTER:
      return Key::kKeypadEnter;
    case GLFW_KEY_ESCAPE:
      return Key::kEscape;
    case GLFW_KEY_TAB:
      return Key::kTab;
    case GLFW_KEY_BACKSPACE:
      return Key::kBackspace;
    case GLFW_KEY_DELETE:
      return Key::kDelete;
    case GLFW_KEY_INSERT:
      return Key::kInsert;
    case GLFW_KEY_LEFT:
      return Key::kLeft;
    case GLFW_KEY_RIGHT:
      return Key::kRight;
    case GLFW_KEY_UP:
      return Key::kUp;
    case GLFW_KEY_DOWN:
      return Key::kDown;
    case GLFW_KEY_HOME:
      return Key::kHome;
    case GLFW_KEY_END:
      return Key::kEnd;
    case GLFW_KEY_PAGE_UP:
      return Key::kPageUp;
    case GLFW_KEY_PAGE_DOWN:
      return Key::kPageDown;
    case GLFW_KEY_MINUS:
    case GLFW_KEY_KP_SUBTRACT:
      return Key::kMinus;
    case GLFW_KEY_EQUAL:
    case GLFW_KEY_KP_ADD:
      return Key::kEqual;
    case GLFW_KEY_COMMA:
      return Key::kComma;
    case GLFW_KEY_PERIOD:
    case GLFW_KEY_KP_DECIMAL:
      return Key::kPeriod;
    case GLFW_KEY_SLASH:
    case GLFW_KEY_KP_DIVIDE:
      return Key::kSlash;
    case GLFW_KEY_SEMICOLON:
      return Key::kSemicolon;
    case GLFW_KEY_APOSTROPHE:
      return Key::kApostrophe;
    case GLFW_KEY_GRAVE_ACCENT:
      return Key::kGrave;
    case GLFW_KEY_LEFT_BRACKET:
      return Key::kLeftBracket;
    case GLFW_KEY_RIGHT_BRACKET:
      return Key::kRightBracket;
    case GLFW_KEY_BACKSLASH:
      return Key::kBackslash;
    default:
      return Key::kNone;
  }
}

Modifiers modifiers_from_glfw(int bits) {
  return {.ctrl = (bits & GLFW_MOD_CONTROL) != 0,
          .shift = (bits & GLFW_MOD_SHIFT) != 0,
          .alt = (bits & GLFW_MOD_ALT) != 0,
          .super = (bits & GLFW_MOD_SUPER) != 0};
}

}  // namespace stillpoint
