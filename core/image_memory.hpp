#pragma once

#include <cstddef>

namespace stillpoint {

/// What became of requests for the memory of images since keep_image_memory().
struct ImageMemory {
  long reused = 0;             ///< requests met by a block that was kept
  long made = 0;               ///< … by the system
  std::size_t kept_bytes = 0;  ///< waiting to be used again
};

/// From here on the memory of images (cv::Mat, those inside OpenCV's functions included) is kept when the
/// last who holds it lets go, and handed to the next image of just that size: frame follows frame at the same
/// sizes, so that after the first few none asks the system. Contents are as undefined as those of fresh
/// memory, and any thread may make and let go of images. For main() and whoever measures; called again it
/// changes nothing.
void keep_image_memory();

[[nodiscard]] ImageMemory image_memory();

/// The same for tables: what take_memory() gave, 64-byte aligned, goes back with the size it was asked for.
[[nodiscard]] void* take_memory(std::size_t bytes);
void give_memory(void* block, std::size_t bytes);

/// Lets a vector live in such memory: for large ones of one size that are made for every frame.
template <typename T>
struct KeptMemory {
  using value_type = T;

  KeptMemory() = default;
  template <typename U>
  KeptMemory(const KeptMemory<U>&) {}  // NOLINT(google-explicit-constructor): as standard allocators do

  [[nodiscard]] T* allocate(std::size_t count) { return static_cast<T*>(take_memory(count * sizeof(T))); }
  void deallocate(T* block, std::size_t count) { give_memory(block, count * sizeof(T)); }

  bool operator==(const KeptMemory&) const { return true; }
};

}  // namespace stillpoint
