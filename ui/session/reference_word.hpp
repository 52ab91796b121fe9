#pragma once

#include <cstddef>

namespace stillpoint {

/// What one of the references that depth-aware motion compares a frame with is called.
[[nodiscard]] inline const char* reference_word(std::size_t index) { return index == 0 ? "near" : "far"; }

}  // namespace stillpoint
