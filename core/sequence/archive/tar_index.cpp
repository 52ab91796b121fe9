#include <algorithm>
#include <charconv>

#include "core/sequence/archive/archive_index.hpp"
#include "core/sequence/bag/byte_reader.hpp"

namespace stillpoint {
namespace {

// The format: POSIX.1-2001, pax; GNU tar's manual, "Basic Tar Format".

constexpr std::uint64_t kBlock = 512;             // bytes: the format's unit
constexpr std::uint64_t kLargestName = 64 << 10;  // bytes, of what says a name

std::string_view field(ByteView block, std::size_t at, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(block.data()) + at, size);
  return text.substr(0, text.find('\0'));
}

/// A number as octal digits, or in base 256 where its first bit is set.
std::optional<std::uint64_t> number(ByteView block, std::size_t at, std::size_t size) {
  if ((block[at] & 0x80U) != 0) {
    std::uint64_t value = block[at] & 0x7FU;
    for (std::size_t i = 1; i < size; ++i) {
      if (value >> 55U != 0) return std::nullopt;
      value = value << 8U | block[at + i];
    }
    return value;
  }
  std::string_view text = field(block, at, size);
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  std::uint64_t value = 0;
  if (text.empty()) return value;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 8);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool is_header(ByteView block) {
  constexpr std::size_t kAt = 148, kSize = 8;  // bytes: where the checksum lies, which is summed as blanks
  const auto told = number(block, kAt, kSize);
  std::uint64_t sum = kSize * ' ';
  for (std::size_t i = 0; i < kBlock; ++i)
    if (i < kAt || i >= kAt + kSize) sum += block[i];
  return told && *told == sum;
}

class Walker {
 public:
  explicit Walker(const RandomFile& file) : file_(file) {}

  std::optional<ArchiveIndex> walk() {
    std::uint64_t at = 0;
    index_.is_cut = true;
    for (; at + kBlock <= file_.size();) {
      const Bytes block = file_.read(at, kBlock);
      if (block.size() < kBlock) break;
      if (std::all_of(block.begin(), block.end(), [](unsigned char c) { return c == 0; })) {
        index_.is_cut = false;
        break;
      }
      const auto size = number(block, 124, 12);
      if (!is_header(block) || !size) break;
      if (!take(block, at + kBlock, size_.value_or(*size))) break;
      const std::uint64_t whole = was_size_;
      const std::uint64_t padded = (whole + kBlock - 1) / kBlock * kBlock;
      if (padded < whole || padded > file_.size() - at - kBlock) {
        at = file_.size();
        break;
      }
      at += kBlock + padded;
    }
    if (at == 0) return std::nullopt;
    for (const auto& [name, target] : links_)
      if (const auto found = index_.files.find(target); found != index_.files.end())
        index_.files.try_emplace(name, found->second);
    return std::move(index_);
  }

 private:
  /// @return false where it claims what cannot be
  bool take(const Bytes& block, std::uint64_t data, std::uint64_t size) {
    const char type = static_cast<char>(block[156]);
    // The size that a header before says is of the file itself, not of another header.
    const bool is_extra = type == 'L' || type == 'K' || type == 'x' || type == 'g';
    if (is_extra) size = number(block, 124, 12).value_or(0);
    const bool has_data =
        type != '1' && type != '2' && type != '5' && type != '3' && type != '4' && type != '6';
    was_size_ = has_data ? size : 0;
    const std::uint64_t there = std::min(was_size_, file_.size() - data);
    if (is_extra) {
      if (size > kLargestName) return type == 'g';
      const Bytes bytes = file_.read(data, there);
      if (type == 'L') name_ = std::string(field(bytes, 0, bytes.size()));
      if (type == 'x') take_pax(ByteReader::to_text(bytes));
      return true;
    }
    std::string name(field(block, 0, 100));
    const bool is_ustar = field(block, 257, 5) == "ustar" && block[262] == 0;
    if (const std::string_view prefix = field(block, 345, 155); is_ustar && !prefix.empty())
      name = std::string(prefix) + "/" + name;
    if (!name_.empty()) name = name_;
    name_.clear(), size_.reset();
    name = archived_name(std::move(name));
    if (name.empty()) return true;
    if (type == '0' || type == '\0' || type == '7')
      index_.files[name] = {data, there, there};
    else if (type == '1')
      links_[name] = archived_name(std::string(field(block, 157, 100)));
    else if (type == '2')
      links_[name] = archived_name(name.substr(0, name.rfind('/') + 1) + std::string(field(block, 157, 100)));
    return true;
  }

  /// Lines of "LENGTH KEY=VALUE\n".
  void take_pax(std::string_view text) {
    while (!text.empty()) {
      std::size_t length = 0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), length);
      const auto begin = static_cast<std::size_t>(end - text.data()) + 1;
      if (error != std::errc() || length <= begin || length > text.size()) return;
      const std::string_view pair = text.substr(begin, length - begin - 1);
      if (pair.starts_with("path=")) name_ = std::string(pair.substr(5));
      if (pair.starts_with("size=")) {
        std::uint64_t size = 0;
        const std::string_view digits = pair.substr(5);
        if (std::from_chars(digits.data(), digits.data() + digits.size(), size).ec == std::errc())
          size_ = size;
      }
      text.remove_prefix(length);
    }
  }

  const RandomFile& file_;
  ArchiveIndex index_;
  std::string name_;                   ///< of the next file, where a header before it says
  std::optional<std::uint64_t> size_;  ///< likewise
  std::uint64_t was_size_ = 0;
  std::map<std::string, std::string> links_;
};

}  // namespace

std::optional<ArchiveIndex> read_tar_index(const RandomFile& file) { return Walker(file).walk(); }

}  // namespace stillpoint
