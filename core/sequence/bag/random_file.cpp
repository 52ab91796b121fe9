#include "core/sequence/bag/random_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "core/error.hpp"

namespace stillpoint {

RandomFile::RandomFile(const std::string& file, std::string path) : path_(std::move(path)) {
  file_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (file_ < 0 || ::fstat(file_, &status) != 0) {
    const int cause = errno;
    if (file_ >= 0) ::close(file_);
    throw InputError(fmt::format("{}: cannot be opened: {}", path_, std::strerror(cause)));
  }
  if (!S_ISREG(status.st_mode)) {
    ::close(file_);
    throw InputError(fmt::format("{}: is no file", path_));
  }
  size_ = static_cast<std::uint64_t>(status.st_size);
}

RandomFile::~RandomFile() { ::close(file_); }

std::size_t RandomFile::read_into(unsigned char* buffer, std::uint64_t offset, std::uint64_t count) const {
  std::size_t had = 0;
  while (had < count) {
    const ssize_t got = ::pread(file_, buffer + had, count - had, static_cast<off_t>(offset + had));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw InputError(fmt::format("{}: cannot be read: {}", path_, std::strerror(errno)));
    if (got == 0) break;  // it became shorter
    had += static_cast<std::size_t>(got);
  }
  return had;
}

Bytes RandomFile::read(std::uint64_t offset, std::uint64_t count) const {
  Bytes bytes(offset >= size_ ? 0 : static_cast<std::size_t>(std::min(count, size_ - offset)));
  bytes.resize(read_into(bytes.data(), offset, bytes.size()));
  return bytes;
}

}  // namespace stillpoint
