#pragma once

#include <cstdint>
#include <string>

#include "core/sequence/image_file.hpp"

namespace stillpoint {

/// A file that is read anywhere, from several threads at once.
class RandomFile {
 public:
  /// @throws InputError in one sentence for one that cannot be opened
  explicit RandomFile(const std::string& path) : RandomFile(path, path) {}
  /// @param path names it in messages, where it stands for another
  RandomFile(const std::string& file, std::string path);
  ~RandomFile();
  RandomFile(const RandomFile&) = delete;
  RandomFile& operator=(const RandomFile&) = delete;

  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

  /// At most so many bytes: what the file has of them.
  /// @throws InputError where the disk fails
  [[nodiscard]] Bytes read(std::uint64_t offset, std::uint64_t count) const;
  /// The same into a buffer of `count` bytes. @return how many it has
  [[nodiscard]] std::size_t read_into(unsigned char* buffer, std::uint64_t offset, std::uint64_t count) const;

 private:
  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace stillpoint
