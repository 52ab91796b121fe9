#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <mutex>
#include <vector>

namespace stillpoint {

class ByteStore;

/// Bytes that were put by. A value: copies share them.
class StoredBytes {
 public:
  StoredBytes() = default;
  [[nodiscard]] std::size_t size() const { return size_; }  ///< bytes
  /// How many of them take memory: none, unless there was no room elsewhere.
  [[nodiscard]] std::size_t bytes_in_memory() const { return here_ ? here_->capacity() : 0; }
  /// Copies all of them to `to`, from any thread.
  /// @throws InputError when the disk does not give them back
  void read(void* to) const;

 private:
  friend class ByteStore;
  std::shared_ptr<const ByteStore> store_;                 // null where they are in memory
  std::shared_ptr<const std::vector<std::uint8_t>> here_;  // where there was no room elsewhere
  std::int64_t offset_ = 0;
  std::size_t size_ = 0;
};

/// Where bytes lie that are seldom asked for, so that they take no memory: a temporary file that has no name
/// and goes with the last who holds any of them. Where there is no room for such a file they stay in memory.
class ByteStore : public std::enable_shared_from_this<ByteStore> {
 public:
  [[nodiscard]] static std::shared_ptr<ByteStore> make();

  [[nodiscard]] StoredBytes put(const void* data, std::size_t bytes);

 private:
  friend class StoredBytes;
  struct Close {
    void operator()(std::FILE* file) const { (void)std::fclose(file); }
  };
  ByteStore() = default;

  mutable std::mutex mutex_;  // guards what follows
  std::unique_ptr<std::FILE, Close> file_;
  bool refused_ = false;
  std::int64_t end_ = 0;
};

}  // namespace stillpoint
