#pragma once

#include "ui/shell/input.hpp"

namespace stillpoint {

/// The key of a GLFW key code; Key::kNone for those we do not name. Left and right modifiers are no keys of
/// ours: they come as Modifiers.
[[nodiscard]] Key key_from_glfw(int glfw_key);

/// Modifiers from GLFW's bits.
[[nodiscard]] Modifiers modifiers_from_glfw(int bits);

}  // namespace stillpoint
