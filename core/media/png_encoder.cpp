#include "core/media/png_encoder.hpp"

#include <libdeflate.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

namespace stillpoint {
namespace {

constexpr int kFastest = 1;  // libdeflate's level
// What the PNG standard has every file begin with.
constexpr std::array<unsigned char, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr unsigned char kFilterSub = 1;
constexpr std::size_t kChunkFrame = 12;  // bytes of a chunk beside its content: length, type, CRC

void put_big_endian(std::vector<unsigned char>& to, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) to.push_back(static_cast<unsigned char>(value >> shift));
}

void put_chunk(std::vector<unsigned char>& png, std::string_view type, const unsigned char* content,
               std::size_t bytes) {
  put_big_endian(png, static_cast<std::uint32_t>(bytes));
  const std::size_t at = png.size();
  png.insert(png.end(), type.begin(), type.end());
  png.insert(png.end(), content, content + bytes);
  put_big_endian(png, libdeflate_crc32(0, png.data() + at, png.size() - at));
}

/// A row in PNG's order of channels, each sample less the one left of it.
template <int kChannels>
void filter_row(const unsigned char* from, int width, unsigned char* to) {
  // Red and blue are swapped; grey has but one place.
  constexpr std::array<int, 4> kOrder = kChannels == 1 ? std::array{0, 0, 0, 0} : std::array{2, 1, 0, 3};
  for (int c = 0; c < kChannels; ++c) to[c] = from[kOrder[static_cast<std::size_t>(c)]];
  for (int x = 1; x < width; ++x) {
    const unsigned char* pixel = from + x * kChannels;
    for (int c = 0; c < kChannels; ++c) {
      const int of = kOrder[static_cast<std::size_t>(c)];
      to[x * kChannels + c] = static_cast<unsigned char>(pixel[of] - pixel[of - kChannels]);
    }
  }
}

}  // namespace

std::vector<unsigned char> encode_plain_png(const cv::Mat& image) {
  const int channels = image.channels();
  if (image.empty() || image.depth() != CV_8U || channels == 2 || channels > 4) return {};
  const auto filter = channels == 1 ? filter_row<1> : channels == 3 ? filter_row<3> : filter_row<4>;
  const std::size_t row_bytes = 1 + static_cast<std::size_t>(image.cols) * static_cast<std::size_t>(channels);
  const std::size_t bytes = row_bytes * static_cast<std::size_t>(image.rows);
  // Not cleared first: each of their bytes is written below.
  const auto rows = std::make_unique_for_overwrite<unsigned char[]>(bytes);
  for (int y = 0; y < image.rows; ++y) {
    unsigned char* row = rows.get() + row_bytes * static_cast<std::size_t>(y);
    row[0] = kFilterSub;
    filter(image.ptr(y), image.cols, row + 1);
  }
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> packer(
      libdeflate_alloc_compressor(kFastest), libdeflate_free_compressor);
  if (!packer) return {};
  const std::size_t most = libdeflate_zlib_compress_bound(packer.get(), bytes);
  const auto content = std::make_unique_for_overwrite<unsigned char[]>(most);
  const std::size_t packed = libdeflate_zlib_compress(packer.get(), rows.get(), bytes, content.get(), most);
  if (packed == 0 || packed > INT32_MAX) return {};

  std::vector<unsigned char> png(kPngSignature.begin(), kPngSignature.end());
  constexpr std::size_t kHeaderBytes = 13;  // bytes of IHDR's content
  png.reserve(png.size() + 3 * kChunkFrame + kHeaderBytes + packed);
  std::vector<unsigned char> header;
  put_big_endian(header, static_cast<std::uint32_t>(image.cols));
  put_big_endian(header, static_cast<std::uint32_t>(image.rows));
  const unsigned char colour_type = channels == 1 ? 0 : channels == 3 ? 2 : 6;
  header.insert(header.end(), {8, colour_type, 0, 0, 0});
  put_chunk(png, "IHDR", header.data(), header.size());
  put_chunk(png, "IDAT", content.get(), packed);
  put_chunk(png, "IEND", nullptr, 0);
  return png;
}

}  // namespace stillpoint
