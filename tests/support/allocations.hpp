#pragma once

#include <cstddef>

namespace stillpoint {

/// What the program asked its allocator for, all threads together, since it began. Counting is linked in with
/// this file: it stands in the way of malloc and its kin for the whole program, other people's libraries
/// included.
struct Allocations {
  long calls = 0;
  long bytes = 0;
  long large_calls = 0;  ///< of kLarge bytes or more
  long large_bytes = 0;

  Allocations operator-(const Allocations& before) const {
    return {calls - before.calls, bytes - before.bytes, large_calls - before.large_calls,
            large_bytes - before.large_bytes};
  }
};

/// From here on a block is an image or a table rather than a list: what allocators may give back to the
/// kernel, and have to be handed anew page by page.
inline constexpr std::size_t kLarge = 64 << 10;

/// False where counting would be in the way of a sanitizer's own; nothing is counted then.
[[nodiscard]] bool counts_allocations();

[[nodiscard]] Allocations allocations_so_far();

/// Calls `seen` with every large block asked for from now on, on the thread that asks; null ends it.
void watch_large_allocations(void (*seen)(std::size_t bytes));

}  // namespace stillpoint
