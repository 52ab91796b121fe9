#include "tests/support/allocations.hpp"

#include <atomic>
#include <cerrno>

// What AddressSanitizer does with memory stands in the same place.
#if defined(__SANITIZE_ADDRESS__) || !defined(__GLIBC__)
#define STILLPOINT_COUNTS 0
#else
#define STILLPOINT_COUNTS 1
#endif

namespace stillpoint {
namespace {

std::atomic<long> calls, bytes, large_calls, large_bytes;
std::atomic<void (*)(std::size_t)> watcher;

}  // namespace

bool counts_allocations() { return STILLPOINT_COUNTS != 0; }

Allocations allocations_so_far() {
  return {calls.load(), bytes.load(), large_calls.load(), large_bytes.load()};
}

void watch_large_allocations(void (*seen)(std::size_t bytes)) { watcher = seen; }

#if STILLPOINT_COUNTS
namespace {

void note(std::size_t size) {
  calls.fetch_add(1, std::memory_order_relaxed);
  bytes.fetch_add(static_cast<long>(size), std::memory_order_relaxed);
  if (size < kLarge) return;
  large_calls.fetch_add(1, std::memory_order_relaxed);
  large_bytes.fetch_add(static_cast<long>(size), std::memory_order_relaxed);
  if (const auto seen = watcher.load()) seen(size);
}

}  // namespace
#endif

}  // namespace stillpoint

#if STILLPOINT_COUNTS
// glibc's own, under the names it keeps for who stands in its way.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  stillpoint::note(size);
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  stillpoint::note(count * size);
  return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) {
  stillpoint::note(size);
  return __libc_realloc(block, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  stillpoint::note(size);
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  *block = memalign(alignment, size);
  return *block != nullptr || size == 0 ? 0 : ENOMEM;
}
}
#endif
