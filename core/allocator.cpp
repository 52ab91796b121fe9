#include "core/allocator.hpp"

#include <malloc.h>

namespace stillpoint {

void tune_allocator() {
  // Images come and go by the frame, and so do tables: pages need not be had from the kernel anew each time.
  constexpr int kSharedBytes = 32 << 20, kKeptBytes = 256 << 20;
  mallopt(M_MMAP_THRESHOLD, kSharedBytes);
  mallopt(M_TRIM_THRESHOLD, kKeptBytes);
  // What threads keep apart goes to pieces by itself: two heaps instead of eight a core save a session 50 MB.
  constexpr int kHeaps = 2;
  mallopt(M_ARENA_MAX, kHeaps);
}

}  // namespace stillpoint
