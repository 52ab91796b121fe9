#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace stillpoint {

/// JSON of a text that may hold anything. What lies deeper than kDeepestJson lists and objects is left out:
/// all that copies, compares or prints such values calls itself once a level.
/// @param throws false: what is no JSON comes back discarded
/// @throws nlohmann::json::parse_error
template <typename Json = nlohmann::json>
[[nodiscard]] Json parse_json(std::string_view text, bool throws = true) {
  // Levels: many more than files of ours have, and as many calls fit a stack.
  constexpr int kDeepestJson = 200;
  return Json::parse(
      text, [](int depth, typename Json::parse_event_t, const Json&) { return depth < kDeepestJson; },
      throws);
}

}  // namespace stillpoint
