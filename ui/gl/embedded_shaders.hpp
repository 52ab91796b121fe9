#pragma once

#include <string_view>

namespace stillpoint {

/// The text of a file of shaders/ as it was at build time; `file_name` as in "line.vert".
/// @throws std::out_of_range for a name that shaders/ does not have.
[[nodiscard]] std::string_view embedded_shader(std::string_view file_name);

}  // namespace stillpoint
