#include "core/media/png_decoder.hpp"

#include <libdeflate.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <span>
#include <string_view>

#include "core/media/png_filters.hpp"

namespace stillpoint {
namespace {

struct Header {
  int width = 0, height = 0, bits = 0, channels = 0;

  [[nodiscard]] int pixel_bytes() const { return channels * bits / 8; }
  [[nodiscard]] std::size_t row_bytes() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(pixel_bytes());
  }
};

std::uint32_t big_endian(const unsigned char* bytes) {
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 |
         bytes[3];
}

/// The IHDR chunk's thirteen bytes; nothing for a kind of image that is not decoded here.
std::optional<Header> read_header(const unsigned char* bytes) {
  constexpr std::uint32_t kWidest = 1U << 20;  // px: products of sides and bytes stay within 64 bits
  constexpr unsigned char kGrey = 0, kColour = 2, kColourAlpha = 6;  // IHDR's colour types
  const std::uint32_t width = big_endian(bytes), height = big_endian(bytes + 4);
  const unsigned char bits = bytes[8], colour = bytes[9];
  if (width == 0 || height == 0 || width > kWidest || height > kWidest || (bits != 8 && bits != 16) ||
      bytes[10] != 0 || bytes[11] != 0 || bytes[12] != 0)
    return std::nullopt;
  Header header{static_cast<int>(width), static_cast<int>(height), bits, 0};
  if (colour == kGrey) header.channels = 1;
  if (colour == kColour) header.channels = 3;
  if (colour == kColourAlpha) header.channels = 4;
  if (header.channels == 0) return std::nullopt;
  return header;
}

struct Chunks {
  Header header;
  std::span<const unsigned char> packed;  // all IDAT chunks, one behind the other
  std::vector<unsigned char> joined;      // … here where there are several
};

std::optional<Chunks> read_chunks(const std::vector<unsigned char>& bytes) {
  constexpr std::size_t kSignature = 8, kFrame = 12, kHeader = 13;  // bytes; a frame: length, name, checksum
  std::optional<Header> header;
  std::span<const unsigned char> packed;
  std::vector<unsigned char> joined;
  const auto join = [&](std::span<const unsigned char> more) {
    if (joined.empty()) {
      joined.reserve(bytes.size());
      joined.assign(packed.begin(), packed.end());
    }
    joined.insert(joined.end(), more.begin(), more.end());
  };
  for (std::size_t at = kSignature; at + kFrame <= bytes.size();) {
    const std::size_t length = big_endian(&bytes[at]);
    if (length > bytes.size() - at - kFrame) return std::nullopt;
    const std::string_view name(reinterpret_cast<const char*>(&bytes[at + 4]), 4);
    const unsigned char* data = &bytes[at] + 8;
    if (name == "IHDR" && length == kHeader && !header)
      header = read_header(data);
    else if (name == "IDAT" && packed.empty() && joined.empty())
      packed = {data, length};
    else if (name == "IDAT")
      join({data, length});
    else if (name == "tRNS" || name == "IHDR")
      return std::nullopt;
    else if (name == "IEND")
      break;
    if (!header) return std::nullopt;
    at += length + kFrame;
  }
  if (!joined.empty()) packed = joined;
  if (!header || packed.empty()) return std::nullopt;
  return Chunks{*header, packed, std::move(joined)};
}

/// All rows of packed pixels, each behind the byte that names its filter, and kPngRowSlack bytes of room.
std::unique_ptr<unsigned char[]> inflate(const Chunks& chunks) {
  constexpr std::size_t kMostInflated = 1032;  // bytes a byte, of Deflate at its best
  const std::size_t size = (chunks.header.row_bytes() + 1) * static_cast<std::size_t>(chunks.header.height);
  if (size / kMostInflated > chunks.packed.size()) return nullptr;
  const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> inflater(
      libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
  auto rows = std::make_unique_for_overwrite<unsigned char[]>(size + kPngRowSlack);
  if (!inflater || libdeflate_zlib_decompress(inflater.get(), chunks.packed.data(), chunks.packed.size(),
                                              rows.get(), size, nullptr) != LIBDEFLATE_SUCCESS)
    return nullptr;
  std::fill_n(rows.get() + size, kPngRowSlack, static_cast<unsigned char>(0));
  return rows;
}

/// From PNG's order to the processor's and OpenCV's: big-endian samples, red first.
void reorder(cv::Mat& image) {
  if (image.depth() == CV_16U && std::endian::native == std::endian::little) {
    const std::span samples(image.ptr<std::uint16_t>(),
                            image.total() * static_cast<std::size_t>(image.channels()));
    for (std::uint16_t& sample : samples) sample = static_cast<std::uint16_t>(sample >> 8 | sample << 8);
  }
  if (image.channels() < 3) return;
  cv::Mat turned;  // in its own place it would be copied first
  cv::cvtColor(image, turned, image.channels() == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_RGBA2BGRA);
  image = std::move(turned);
}

}  // namespace

cv::Mat decode_plain_png(const std::vector<unsigned char>& bytes) {
  const std::optional<Chunks> chunks = read_chunks(bytes);
  if (!chunks) return {};
  const Header& header = chunks->header;
  const auto rows = inflate(*chunks);
  if (!rows) return {};
  cv::Mat image(header.height, header.width,
                CV_MAKETYPE(header.bits == 16 ? CV_16U : CV_8U, header.channels));
  if (!undo_png_filters(rows.get(), image)) return {};
  reorder(image);
  return image;
}

}  // namespace stillpoint
