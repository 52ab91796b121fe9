#include "core/sequence/image_file.hpp"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>
#include <set>
#include <vector>

#include "core/error.hpp"
#include "core/media/image_codec.hpp"

namespace stillpoint {
namespace {

// What the PNG standard has every file begin with.
constexpr std::array<unsigned char, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::uint32_t kLargestSide = 16384;  // px: no camera has more, and what claims more is damaged

std::uint32_t big_endian(const unsigned char* p) {
  return static_cast<std::uint32_t>(p[0]) << 24 | static_cast<std::uint32_t>(p[1]) << 16 |
         static_cast<std::uint32_t>(p[2]) << 8 | p[3];
}

/// Bits of a pixel as a PNG stores it. @param header what its IHDR holds
std::uint64_t bits_a_pixel(const unsigned char* header) {
  const int colour_type = header[9];
  const int channels = colour_type == 2 ? 3 : colour_type == 4 ? 2 : colour_type == 6 ? 4 : 1;
  return static_cast<std::uint64_t>(channels) * header[8];
}

/// Why a PNG is not whole, or nothing; it is left without the chunks that say nothing about pixels, which are
/// what libpng prints warnings about.
std::string check_png(Bytes& bytes) {
  std::size_t kept = kPngSignature.size();
  // Deflate packs 1032 bytes into one at most (zlib's technical details), so that what is decoded is bounded
  // by the file.
  constexpr std::uint64_t kBitsAByte = 8 * 1032;
  std::uint64_t width = 0, height = 0, bits = 0, packed = 0;
  for (std::size_t at = kPngSignature.size();;) {
    if (bytes.size() - at < 12) return "is truncated";
    unsigned char* const chunk = bytes.data() + at;
    const std::size_t length = big_endian(chunk);
    if (length > bytes.size() - at - 12) return "is truncated";
    const std::string_view type(reinterpret_cast<const char*>(chunk + 4), 4);
    // CRC-32 as PNG's specification (ISO 15948, annex D) defines it.
    if (libdeflate_crc32(0, chunk + 4, length + 4) != big_endian(chunk + 8 + length))
      return "is damaged (a checksum is wrong)";
    if (at == kPngSignature.size()) {
      if (type != "IHDR" || length != 13) return "is damaged (it has no PNG header)";
      width = big_endian(chunk + 8), height = big_endian(chunk + 12), bits = bits_a_pixel(chunk + 8);
      if (width == 0 || height == 0 || width > kLargestSide || height > kLargestSide)
        return fmt::format("claims a size of {}x{} px, expected 1 to {} px a side", width, height,
                           kLargestSide);
    }
    if (type == "IDAT") packed += length;
    const bool ends = type == "IEND", critical = (chunk[4] & 0x20U) == 0;
    if (critical || type == "tRNS") {
      // Most have no others: nothing is moved then.
      if (kept != at) std::memmove(bytes.data() + kept, chunk, length + 12);
      kept += length + 12;
    }
    at += length + 12;
    if (ends) {
      const std::size_t size = bytes.size();
      bytes.resize(kept);
      if (width * height * bits <= kBitsAByte * packed) return {};
      return fmt::format("is damaged (it claims {}x{} px, more than its {} bytes can hold)", width, height,
                         size);
    }
  }
}

/// JPEG streams end in FF D9, perhaps with padding behind it.
bool jpeg_has_its_end(const Bytes& bytes) {
  const std::size_t tail = bytes.size() > 64 ? bytes.size() - 64 : 0;
  for (std::size_t i = bytes.size() - 1; i > tail; --i)
    if (bytes[i] == 0xD9 && bytes[i - 1] == 0xFF) return true;
  return false;
}

bool begins_with(const Bytes& bytes, std::string_view magic) {
  return bytes.size() >= magic.size() &&
         std::equal(magic.begin(), magic.end(), bytes.begin(),
                    [](char a, unsigned char b) { return static_cast<unsigned char>(a) == b; });
}

/// Whether the first bytes are those of a format that is read. OpenCV is asked for no other: it would hand
/// them to whatever decoders it was built with.
bool is_read_format(const Bytes& bytes) {
  using namespace std::string_view_literals;
  for (const std::string_view magic : {"\x89PNG"sv, "\xFF\xD8\xFF"sv, "BM"sv, "II*\0"sv, "MM\0*"sv, "RIFF"sv,
                                       "P1"sv, "P2"sv, "P3"sv, "P4"sv, "P5"sv, "P6"sv})
    if (begins_with(bytes, magic)) return true;
  return false;
}

/// Formats that depth is kept in and that are not read: what a file of one says, and the way on.
std::string other_format(const Bytes& bytes) {
  const auto begins = [&](std::string_view magic) { return begins_with(bytes, magic); };
  const char* kind = begins("\x93NUMPY")            ? "a NumPy array"
                     : begins("\x76\x2f\x31\x01")   ? "an OpenEXR image"
                     : begins("Pf") || begins("PF") ? "a PFM image"
                     : begins("PK\x03\x04")         ? "a zip archive"
                                                    : nullptr;
  if (kind == nullptr) return {};
  return fmt::format("is {}, which is not read; depth is expected as a PNG of 16 bits", kind);
}

}  // namespace

std::string read_bytes(const std::string& path, Bytes& bytes) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) return "is missing";
  if (!std::filesystem::is_regular_file(status)) return "is no file";
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file) return fmt::format("cannot be read: {}", std::strerror(errno));
  // By parts that stay in the cache, until no more come: whatever its size was said to be, it may be growing.
  constexpr std::size_t kPart = 64 << 10, kMostReserved = 64 << 20;  // bytes
  bytes.clear();
  const auto said = std::filesystem::file_size(path, error);
  bytes.reserve(std::min<std::size_t>(error ? kPart : said, kMostReserved));
  for (std::vector<char> part(kPart); file;) {
    file.read(part.data(), kPart);
    bytes.insert(bytes.end(), part.begin(), part.begin() + file.gcount());
  }
  if (bytes.empty()) return "is empty (0 bytes)";
  return {};
}

bool is_image_name(const std::string& file) {
  static const std::set<std::string> kinds = {".png",  ".jpg", ".jpeg", ".bmp", ".tif",
                                              ".tiff", ".ppm", ".pgm",  ".webp"};
  std::string kind = std::filesystem::path(file).extension().string();
  std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::tolower(c); });
  return kinds.count(kind) > 0;
}

ImageRead read_image(const std::string& path) {
  Bytes bytes;
  ImageRead result;
  try {
    const std::string fault = read_bytes(path, bytes);
    if (!fault.empty()) result.problem = fmt::format("{} {}", path, fault);
  } catch (const std::exception& error) {
    result.problem = fmt::format("{} cannot be read", path);
  }
  return result.problem.empty() ? decode_image(path, std::move(bytes)) : result;
}

ImageRead decode_image(const std::string& path, Bytes bytes) {
  ImageRead result;
  try {
    std::string fault = bytes.empty() ? "is empty (0 bytes)" : "";
    if (fault.empty() && bytes.size() >= kPngSignature.size() &&
        std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin())) {
      fault = check_png(bytes);
    } else if (fault.empty() && bytes.size() > 3 && bytes[0] == 0xFF && bytes[1] == 0xD8) {
      fault = jpeg_has_its_end(bytes) ? "" : "is truncated";
    }
    if (fault.empty()) {
      // The orientation tag is ignored, as it must be: calibrations speak of stored
      // pixels.
      fault = other_format(bytes);
      result.is_other_format = !fault.empty();
      if (fault.empty() && is_read_format(bytes)) result.image = decode_pixels(bytes);
      if (fault.empty() && result.image.empty()) fault = "is no image that can be decoded";
    }
    if (!fault.empty()) result.problem = fmt::format("{} {}", path, fault);
  } catch (const InputError& error) {
    result.problem = fmt::format("{} cannot be decoded: {}", path, error.what());
  } catch (const std::exception& error) {
    result.image.release();
    result.problem = fmt::format("{} cannot be decoded", path);
  }
  return result;
}

cv::Mat to_8bit(const cv::Mat& image) {
  cv::Mat result = image;
  if (image.depth() == CV_16U)
    image.convertTo(result, CV_8U, 1.0 / 257.0);
  else if (image.depth() != CV_8U)
    cv::normalize(image, result, 0, 255, cv::NORM_MINMAX, CV_8U);
  if (result.channels() == 4) cv::cvtColor(result, result, cv::COLOR_BGRA2BGR);
  if (result.channels() == 2) cv::extractChannel(result, result, 0);
  return result;
}

cv::Mat to_gray(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

}  // namespace stillpoint
