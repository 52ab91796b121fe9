#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace stillpoint {

// The part of an interactive report that is looked at with one cursor.

[[nodiscard]] std::string live_markup();

/// Its data and scripts, which stand at the page's end. @param data as live_data() gives it
[[nodiscard]] std::string live_scripts(const nlohmann::ordered_json& data);

[[nodiscard]] std::string live_style();

}  // namespace stillpoint
