#include "core/sequence/bag/decompress.hpp"

#include <bzlib.h>
#include <fmt/format.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

#include "core/text_file.hpp"

namespace stillpoint {
namespace {

// Bytes: room grows by doubling, and by no more than this at once, whatever a damaged size claims.
constexpr std::size_t kFirstOutput = 64 << 10, kMostGrowth = 16 << 20;

/// Output that doubles up to what is wanted.
class Output {
 public:
  explicit Output(std::uint64_t most) : most_(static_cast<std::size_t>(std::min(most, kLargestChunk + 1))) {
    bytes_.resize(std::min(kFirstOutput, most_));
  }
  [[nodiscard]] bool is_full() const { return size_ == most_; }
  [[nodiscard]] unsigned char* end() { return bytes_.data() + size_; }
  /// Room behind the end: some, unless it is full.
  [[nodiscard]] std::size_t room() {
    if (size_ == bytes_.size()) bytes_.resize(std::min(most_, size_ + std::min(size_, kMostGrowth)));
    return bytes_.size() - size_;
  }
  void add(std::size_t count) { size_ += count; }
  [[nodiscard]] Bytes take() {
    if (size_ > kLargestChunk)
      throw MalformedBytes(fmt::format("holds a chunk of more than {} MB", kLargestChunk >> 20U));
    bytes_.resize(size_);
    return std::move(bytes_);
  }
  [[nodiscard]] bool is_empty() const { return size_ == 0; }

 private:
  std::size_t most_, size_ = 0;
  Bytes bytes_;
};

void unpack_bz2(ByteView packed, Output& output) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw MalformedBytes("cannot be unpacked: no memory");
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> end(&stream, BZ2_bzDecompressEnd);
  // The library takes its input as not const, and leaves it alone.
  stream.next_in = reinterpret_cast<char*>(const_cast<unsigned char*>(packed.data()));
  stream.avail_in = static_cast<unsigned>(packed.size());
  while (!output.is_full()) {
    const std::size_t room = output.room();
    stream.next_out = reinterpret_cast<char*>(output.end());
    stream.avail_out = static_cast<unsigned>(room);
    const int state = BZ2_bzDecompress(&stream);
    output.add(room - stream.avail_out);
    const bool stuck = stream.avail_out == room && stream.avail_in == 0;
    if (state != BZ_OK || stuck) break;
  }
}

void unpack_lz4(ByteView packed, Output& output) {
  LZ4F_dctx* created = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&created, LZ4F_VERSION)) != 0)
    throw MalformedBytes("cannot be unpacked: no memory");
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(created,
                                                                             LZ4F_freeDecompressionContext);
  while (!output.is_full()) {
    std::size_t room = output.room(), used = packed.size();
    const std::size_t state =
        LZ4F_decompress(context.get(), output.end(), &room, packed.data(), &used, nullptr);
    if (LZ4F_isError(state) != 0) break;
    output.add(room);
    packed = packed.subspan(used);
    if (state == 0 || (room == 0 && used == 0)) break;
  }
}

void unpack_zstd(ByteView packed, Output& output) {
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                             ZSTD_freeDStream);
  if (!stream) throw MalformedBytes("cannot be unpacked: no memory");
  ZSTD_inBuffer input{packed.data(), packed.size(), 0};
  while (!output.is_full()) {
    const std::size_t room = output.room();  // before its end, which may move
    ZSTD_outBuffer out{output.end(), room, 0};
    const std::size_t before = input.pos;
    const std::size_t state = ZSTD_decompressStream(stream.get(), &out, &input);
    if (ZSTD_isError(state) != 0) break;
    output.add(out.pos);
    if (state == 0 || (out.pos == 0 && input.pos == before)) break;
  }
}

}  // namespace

Compression compression_by_name(std::string_view name) {
  if (name.empty() || name == "none") return Compression::none;
  if (name == "bz2") return Compression::bz2;
  if (name == "lz4") return Compression::lz4;
  if (name == "zstd") return Compression::zstd;
  throw MalformedBytes(fmt::format("has chunks of compression {}, which is not read", in_quotes(name)));
}

Bytes decompress(Compression compression, ByteView packed, std::uint64_t most) {
  if (compression == Compression::none) {
    const auto count = static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(most, packed.size()));
    return {packed.begin(), packed.begin() + count};
  }
  if (packed.empty() || most == 0) return {};
  Output output(most);
  if (compression == Compression::bz2) unpack_bz2(packed, output);
  if (compression == Compression::lz4) unpack_lz4(packed, output);
  if (compression == Compression::zstd) unpack_zstd(packed, output);
  if (output.is_empty()) throw MalformedBytes("holds a chunk that cannot be unpacked");
  return output.take();
}

}  // namespace stillpoint
