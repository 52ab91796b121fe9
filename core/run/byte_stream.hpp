#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace stillpoint {

static_assert(std::endian::native == std::endian::little, "files are little-endian, and written as they lie");

/// A value that is written as it lies in memory.
template <typename T>
concept PlainValue = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Bytes being put together.
class ByteStreamWriter {
 public:
  template <PlainValue T>
  void operator()(const T& value) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(T));
  }
  void operator()(const std::string& text) {
    (*this)(static_cast<std::uint32_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }
  void operator()(const std::vector<std::uint8_t>& bytes) {
    (*this)(static_cast<std::uint32_t>(bytes.size()));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  void clear() { bytes_.clear(); }
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

/// Bytes being taken apart.
class ByteStreamReader {
 public:
  /// Thrown when more is wanted than there is, and for what cannot be.
  struct Exhausted : std::runtime_error {
    Exhausted() : std::runtime_error("ends early") {}
  };

  explicit ByteStreamReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <PlainValue T>
  void operator()(T& value) {
    const auto from = take(sizeof(T));
    std::memcpy(&value, from.data(), sizeof(T));
  }
  void operator()(bool& value) {
    std::uint8_t byte = 0;
    (*this)(byte);
    value = byte != 0;
  }
  void operator()(std::string& text) {
    const auto from = take(length());
    text.assign(from.begin(), from.end());
  }
  void operator()(std::vector<std::uint8_t>& bytes) {
    const auto from = take(length());
    bytes.assign(from.begin(), from.end());
  }
  /// The number of things that follow, each of at least `least_size` bytes: never more than can be there.
  [[nodiscard]] std::uint32_t count(std::size_t least_size) {
    std::uint32_t value = 0;
    (*this)(value);
    if (value > bytes_.size() / least_size) throw Exhausted();
    return value;
  }
  [[nodiscard]] bool empty() const { return bytes_.empty(); }

 private:
  [[nodiscard]] std::size_t length() { return count(1); }
  std::span<const std::uint8_t> take(std::size_t size) {
    if (size > bytes_.size()) throw Exhausted();
    const auto taken = bytes_.first(size);
    bytes_ = bytes_.subspan(size);
    return taken;
  }

  std::span<const std::uint8_t> bytes_;
};

}  // namespace stillpoint
