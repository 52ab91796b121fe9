#include <imgui.h>

#include <array>
#include <utility>

#include "ui/shell/input.hpp"

// ImGui 1.87 replaced the arrays of key states by a queue of named keys; this file knows both ways.

namespace stillpoint {
namespace {

#if IMGUI_VERSION_NUM < 18700

constexpr std::array<std::pair<ImGuiKey_, Key>, 22> kImGuiKeys = {{
    {ImGuiKey_Tab, Key::kTab},
    {ImGuiKey_LeftArrow, Key::kLeft},
    {ImGuiKey_RightArrow, Key::kRight},
    {ImGuiKey_UpArrow, Key::kUp},
    {ImGuiKey_DownArrow, Key::kDown},
    {ImGuiKey_PageUp, Key::kPageUp},
    {ImGuiKey_PageDown, Key::kPageDown},
    {ImGuiKey_Home, Key::kHome},
    {ImGuiKey_End, Key::kEnd},
    {ImGuiKey_Insert, Key::kInsert},
    {ImGuiKey_Delete, Key::kDelete},
    {ImGuiKey_Backspace, Key::kBackspace},
    {ImGuiKey_Space, Key::kSpace},
    {ImGuiKey_Enter, Key::kEnter},
    {ImGuiKey_Escape, Key::kEscape},
    {ImGuiKey_KeyPadEnter, Key::kKeypadEnter},
    {ImGuiKey_A, Key::kA},
    {ImGuiKey_C, Key::kC},
    {ImGuiKey_V, Key::kV},
    {ImGuiKey_X, Key::kX},
    {ImGuiKey_Y, Key::kY},
    {ImGuiKey_Z, Key::kZ},
}};

int native(Key key) { return static_cast<int>(key); }

void apply_modifiers(ImGuiIO& io, const Modifiers& modifiers) {
  io.KeyCtrl = modifiers.ctrl;
  io.KeyShift = modifiers.shift;
  io.KeyAlt = modifiers.alt;
  io.KeySuper = modifiers.super;
}

void apply(ImGuiIO& io, const MouseMoved& event) { io.MousePos = {event.x, event.y}; }

void apply(ImGuiIO& io, const MouseButton& event) {
  apply_modifiers(io, event.modifiers);
  if (event.button >= 0 && event.button < 5) io.MouseDown[event.button] = event.down;
}

void apply(ImGuiIO& io, const MouseWheel& event) {
  apply_modifiers(io, event.modifiers);
  io.MouseWheelH += event.dx;
  io.MouseWheel += event.dy;
}

void apply(ImGuiIO& io, const KeyChanged& event) {
  apply_modifiers(io, event.modifiers);
  io.KeysDown[native(event.key)] = event.down;
}

void apply(ImGuiIO& io, const FocusChanged& event) {
  io.AddFocusEvent(event.focused);
  if (event.focused) return;
  // Releases that happen elsewhere are never told: nothing stays held in a window left behind.
  for (bool& down : io.KeysDown) down = false;
  for (bool& down : io.MouseDown) down = false;
  apply_modifiers(io, {});
}

#else

ImGuiKey native(Key key) {
  const int index = static_cast<int>(key);
  const auto among = [index](Key first, ImGuiKey imgui_first) {
    return static_cast<ImGuiKey>(imgui_first + index - static_cast<int>(first));
  };
  if (key >= Key::k0 && key <= Key::k9) return among(Key::k0, ImGuiKey_0);
  if (key >= Key::kA && key <= Key::kZ) return among(Key::kA, ImGuiKey_A);
  if (key >= Key::kF1 && key <= Key::kF12) return among(Key::kF1, ImGuiKey_F1);
  constexpr std::array<ImGuiKey, 27> kOthers = {
      ImGuiKey_Space,       ImGuiKey_Enter,        ImGuiKey_KeypadEnter, ImGuiKey_Escape,
      ImGuiKey_Tab,         ImGuiKey_Backspace,    ImGuiKey_Delete,      ImGuiKey_Insert,
      ImGuiKey_LeftArrow,   ImGuiKey_RightArrow,   ImGuiKey_UpArrow,     ImGuiKey_DownArrow,
      ImGuiKey_Home,        ImGuiKey_End,          ImGuiKey_PageUp,      ImGuiKey_PageDown,
      ImGuiKey_Minus,       ImGuiKey_Equal,        ImGuiKey_Comma,       ImGuiKey_Period,
      ImGuiKey_Slash,       ImGuiKey_Semicolon,    ImGuiKey_Apostrophe,  ImGuiKey_GraveAccent,
      ImGuiKey_LeftBracket, ImGuiKey_RightBracket, ImGuiKey_Backslash};
  if (key >= Key::kSpace && key < Key::kCount) {
    return kOthers[static_cast<std::size_t>(index - static_cast<int>(Key::kSpace))];
  }
  return ImGuiKey_None;
}

void apply_modifiers(ImGuiIO& io, const Modifiers& modifiers) {
#if IMGUI_VERSION_NUM < 18837
  io.AddKeyEvent(ImGuiKey_ModCtrl, modifiers.ctrl);
  io.AddKeyEvent(ImGuiKey_ModShift, modifiers.shift);
  io.AddKeyEvent(ImGuiKey_ModAlt, modifiers.alt);
  io.AddKeyEvent(ImGuiKey_ModSuper, modifiers.super);
#else
  io.AddKeyEvent(ImGuiMod_Ctrl, modifiers.ctrl);
  io.AddKeyEvent(ImGuiMod_Shift, modifiers.shift);
  io.AddKeyEvent(ImGuiMod_Alt, modifiers.alt);
  io.AddKeyEvent(ImGuiMod_Super, modifiers.super);
#endif
}

void apply(ImGuiIO& io, const MouseMoved& event) { io.AddMousePosEvent(event.x, event.y); }

void apply(ImGuiIO& io, const MouseButton& event) {
  apply_modifiers(io, event.modifiers);
  io.AddMouseButtonEvent(event.button, event.down);
}

void apply(ImGuiIO& io, const MouseWheel& event) {
  apply_modifiers(io, event.modifiers);
  io.AddMouseWheelEvent(event.dx, event.dy);
}

void apply(ImGuiIO& io, const KeyChanged& event) {
  apply_modifiers(io, event.modifiers);
  io.AddKeyEvent(native(event.key), event.down);
}

void apply(ImGuiIO& io, const FocusChanged& event) { io.AddFocusEvent(event.focused); }

#endif

void apply(ImGuiIO& io, const TextTyped& event) { io.AddInputCharacter(event.codepoint); }

void apply(ImGuiIO&, const FilesDropped&) {}

}  // namespace

void set_up_imgui_keys() {
#if IMGUI_VERSION_NUM < 18700
  for (const auto& [imgui_key, key] : kImGuiKeys) ImGui::GetIO().KeyMap[imgui_key] = native(key);
#else
  // Events are already spread over frames by InputQueue, in the window and in recordings alike.
  ImGui::GetIO().ConfigInputTrickleEventQueue = false;
#endif
}

void apply_to_imgui(const InputEvent& event) {
  ImGuiIO& io = ImGui::GetIO();
  std::visit([&io](const auto& one) { apply(io, one); }, event);
}

bool is_key_pressed(Key key, bool repeat) { return ImGui::IsKeyPressed(native(key), repeat); }

bool is_key_down(Key key) { return ImGui::IsKeyDown(native(key)); }

bool is_chord_pressed(const KeyChord& chord, bool repeat) {
  if (chord.key == Key::kNone || !is_key_pressed(chord.key, repeat)) return false;
  const ImGuiIO& io = ImGui::GetIO();
  return chord.modifiers == Modifiers{io.KeyCtrl, io.KeyShift, io.KeyAlt, io.KeySuper};
}

}  // namespace stillpoint
