#pragma once

#include <string_view>

namespace stillpoint {

/// The text of a file in assets/report, by its name.
/// @throws std::out_of_range for a file that there is not
[[nodiscard]] std::string_view embedded_report(std::string_view file_name);

}  // namespace stillpoint
