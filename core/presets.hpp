#pragma once

#include <string>
#include <vector>

namespace stillpoint {

/// Names of the presets that load_config() knows, in alphabetical order.
[[nodiscard]] std::vector<std::string> preset_names();

}  // namespace stillpoint
