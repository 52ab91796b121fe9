#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/config.hpp"

namespace stillpoint {

// Parameters as people read them, and how two configs differ. No ImGui.

/// "motion.max_corners": the section, "Max corners".
[[nodiscard]] std::string section_of(const Parameter& parameter);
[[nodiscard]] std::string label_of(const Parameter& parameter);
/// "some_words" as a heading: "Some words".
[[nodiscard]] std::string heading_of(const std::string& section);
[[nodiscard]] std::string value_text(const Parameter& parameter);
/// Whether it is off (0) or on (1), and nothing between.
[[nodiscard]] bool is_switch(const Parameter& parameter);
/// "px, 1 to 64"
[[nodiscard]] std::string range_text(const Parameter& parameter);

/// Whether key, label or help holds the words, whatever their case.
[[nodiscard]] bool matches(const Parameter& parameter, std::string_view words);

/// Whether the parameter acts in the motion stages, which are recomputed while it is changed.
[[nodiscard]] bool is_live(const Parameter& parameter);

/// A parameter in which a config differs from another.
struct ParameterChange {
  std::string key, value, before;
};
[[nodiscard]] std::vector<ParameterChange> changes(const Config& config, const Config& from);

/// What a run with this config is called beside one with `from`: "motion.border_px 7, +2".
[[nodiscard]] std::string change_name(const Config& config, const Config& from);

}  // namespace stillpoint
