#include "core/run/record_chunks.hpp"

#include <fmt/format.h>
#include <libdeflate.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <new>
#include <string_view>

#include "core/counted.hpp"

namespace stillpoint {
namespace {

constexpr std::string_view kMagic = "STILLREC", kEndMagic = "STILLEND";
constexpr std::uint32_t kMostBytes = 1U << 28U;  // of one chunk unpacked: more is damage
constexpr std::uint64_t kMostPacked = 1032;      // bytes that zlib packs into one, at most
constexpr int kPackingLevel = 1;                 // fast: the run waits for it
// Bytes: its kind, two sizes and a checksum.
constexpr std::size_t kChunkHead = 1 + 3 * sizeof(std::uint32_t);

void append(std::vector<std::uint8_t>& to, const void* from, std::size_t bytes) {
  const auto* first = static_cast<const std::uint8_t*>(from);
  to.insert(to.end(), first, first + bytes);
}

bool unpack(const std::vector<std::uint8_t>& packed, std::vector<std::uint8_t>& content) {
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> inflater(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  // Where the length is not told, another one than that of the content is refused.
  return inflater && libdeflate_zlib_decompress(inflater.get(), packed.data(), packed.size(), content.data(),
                                                content.size(), nullptr) == LIBDEFLATE_SUCCESS;
}

}  // namespace

std::vector<std::uint8_t> records_head() {
  std::vector<std::uint8_t> bytes;
  append(bytes, kMagic.data(), kMagic.size());
  append(bytes, &kRecordsVersion, sizeof(kRecordsVersion));
  return bytes;
}

std::vector<std::uint8_t> records_foot(std::uint64_t tables) {
  std::vector<std::uint8_t> bytes;
  append(bytes, &tables, sizeof(tables));
  append(bytes, kEndMagic.data(), kEndMagic.size());
  return bytes;
}

std::vector<std::uint8_t> packed_chunk(ChunkKind kind, const std::vector<std::uint8_t>& content) {
  // Made once a thread: a run packs a chunk a frame.
  thread_local const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> packer(
      libdeflate_alloc_compressor(kPackingLevel), libdeflate_free_compressor);
  if (!packer) throw std::bad_alloc();
  const std::size_t most = libdeflate_zlib_compress_bound(packer.get(), content.size());
  std::vector<std::uint8_t> bytes(kChunkHead + most);
  const std::size_t length =
      libdeflate_zlib_compress(packer.get(), content.data(), content.size(), bytes.data() + kChunkHead, most);
  bytes.resize(kChunkHead + length);
  const std::array<std::uint32_t, 3> numbers = {static_cast<std::uint32_t>(length),
                                                static_cast<std::uint32_t>(content.size()),
                                                libdeflate_crc32(0, bytes.data() + kChunkHead, length)};
  bytes[0] = static_cast<std::uint8_t>(kind);
  std::memcpy(bytes.data() + 1, numbers.data(), sizeof(numbers));
  return bytes;
}

ChunkFile::ChunkFile(std::filesystem::path path) : path_(std::move(path)), file_(path_, std::ios::binary) {
  if (!file_) throw InputError(fmt::format("{}: cannot be read ({})", path_.string(), std::strerror(errno)));
  std::error_code none;
  bytes_ = std::filesystem::file_size(path_, none);
  if (none) bytes_ = 0;
  std::array<char, kMagic.size()> magic{};
  if (!fetch(0, magic.data(), magic.size()) || !fetch(kMagic.size(), &version_, sizeof(version_)) ||
      std::string_view(magic.data(), magic.size()) != kMagic)
    throw InputError(fmt::format("{}: is no file of records written by `stillpoint run`", path_.string()));
  if (version_ < kOldestRecordsVersion || version_ > kRecordsVersion)
    throw InputError(
        fmt::format("{}: is of version {}, and this program reads versions {} and {}; `stillpoint run … "
                    "--force` writes it anew",
                    path_.string(), version_, kOldestRecordsVersion, kRecordsVersion));
  std::uint64_t tables = 0;
  std::array<char, kEndMagic.size()> end{};
  if (version_ > kOldestRecordsVersion && bytes_ > kRecordsHeadBytes + kRecordsFootBytes &&
      fetch(bytes_ - kRecordsFootBytes, &tables, sizeof(tables)) &&
      fetch(bytes_ - kEndMagic.size(), end.data(), end.size()) &&
      std::string_view(end.data(), end.size()) == kEndMagic)
    tables_ = tables;
}

bool ChunkFile::fetch(std::uint64_t at, void* to, std::size_t bytes) const {
  if (at > bytes_ || bytes > bytes_ - at) return false;
  const std::lock_guard lock(mutex_);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(at));
  file_.read(static_cast<char*>(to), static_cast<std::streamsize>(bytes));
  return static_cast<bool>(file_);
}

ChunkFile::Chunk ChunkFile::read(std::uint64_t at) const {
  std::array<char, kChunkHead> head{};
  if (!fetch(at, head.data(), head.size())) throw ChunkCutShort();
  std::array<std::uint32_t, 3> numbers{};
  std::memcpy(numbers.data(), head.data() + 1, sizeof(numbers));
  const auto [size, unpacked_size, crc] = numbers;
  if (size > bytes_) throw ChunkCutShort();
  if (unpacked_size > kMostBytes || unpacked_size > kMostPacked * size) throw ChunkDamaged();
  std::vector<std::uint8_t> packed(size);
  if (!fetch(at + kChunkHead, packed.data(), size)) throw ChunkCutShort();
  if (libdeflate_crc32(0, packed.data(), size) != crc) throw ChunkDamaged();
  Chunk chunk{static_cast<ChunkKind>(head[0]), std::vector<std::uint8_t>(unpacked_size),
              at + kChunkHead + size};
  if (!unpack(packed, chunk.content)) throw ChunkDamaged();
  return chunk;
}

bool ChunkFile::ends_at(std::uint64_t at) const {
  if (version_ == kOldestRecordsVersion) return true;
  if (bytes_ < at + kRecordsFootBytes) throw ChunkCutShort();
  return bytes_ == at + kRecordsFootBytes && tables_;
}

std::string ChunkFile::cut_short(std::size_t frames) const {
  return fmt::format("{}: is cut short after {}", path_.string(), counted(frames, "frame"));
}

InputError ChunkFile::damaged(std::size_t frames) const {
  return InputError(fmt::format("{}: is damaged after {}", path_.string(), counted(frames, "frame")));
}

}  // namespace stillpoint
