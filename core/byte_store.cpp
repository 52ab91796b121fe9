#include "core/byte_store.hpp"

#include <sys/types.h>

#include <algorithm>

#include "core/error.hpp"

namespace stillpoint {

std::shared_ptr<ByteStore> ByteStore::make() { return std::shared_ptr<ByteStore>(new ByteStore); }

StoredBytes ByteStore::put(const void* data, std::size_t bytes) {
  StoredBytes stored;
  stored.size_ = bytes;
  if (bytes == 0) return stored;
  {
    const std::lock_guard lock(mutex_);
    if (!file_ && !refused_) {
      file_.reset(std::tmpfile());
      refused_ = file_ == nullptr;
      // What cannot be written is to be known at once.
      if (file_) (void)std::setvbuf(file_.get(), nullptr, _IONBF, 0);
    }
    if (file_ && !refused_) {
      const bool written = ::fseeko(file_.get(), static_cast<off_t>(end_), SEEK_SET) == 0 &&
                           std::fwrite(data, 1, bytes, file_.get()) == bytes;
      if (written) {
        stored.store_ = shared_from_this();
        stored.offset_ = end_;
        end_ += static_cast<std::int64_t>(bytes);
        return stored;
      }
      refused_ = true;  // the disk is full: what is there already can still be read
    }
  }
  const auto* first = static_cast<const std::uint8_t*>(data);
  stored.here_ = std::make_shared<const std::vector<std::uint8_t>>(first, first + bytes);
  return stored;
}

void StoredBytes::read(void* to) const {
  if (size_ == 0) return;
  if (here_) {
    std::copy(here_->begin(), here_->end(), static_cast<std::uint8_t*>(to));
    return;
  }
  const std::lock_guard lock(store_->mutex_);
  std::FILE* file = store_->file_.get();
  if (::fseeko(file, static_cast<off_t>(offset_), SEEK_SET) != 0 || std::fread(to, 1, size_, file) != size_)
    throw InputError("what a run left of a frame cannot be read back from the temporary file it was put in");
}

}  // namespace stillpoint
