#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace stillpoint {

/// Bytes that do not hold what they claim. Says what, as the end of a sentence that begins with their place;
/// it is caught where the place is known.
class MalformedBytes : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

using ByteView = std::span<const unsigned char>;

/// Reads little-endian values one after another. Every length is checked against what is left, before
/// anything is allocated.
class ByteReader {
 public:
  explicit ByteReader(ByteView bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t at() const { return at_; }
  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

  /// @throws MalformedBytes where fewer are left, as all below do
  ByteView take(std::uint64_t count) {
    if (count > left()) throw MalformedBytes("ends too early");
    const ByteView taken = bytes_.subspan(at_, static_cast<std::size_t>(count));
    at_ += taken.size();
    return taken;
  }
  template <typename T>
  T number() {
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
    return value;
  }
  /// Bytes behind their 32-bit count.
  ByteView counted() { return take(number<std::uint32_t>()); }
  std::string text() { return to_text(counted()); }

  static std::string to_text(ByteView bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }

 private:
  ByteView bytes_;
  std::size_t at_ = 0;
};

}  // namespace stillpoint
