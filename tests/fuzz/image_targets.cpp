// Images: PNG and JPEG, which is what sequences are made of. Other formats are OpenCV's to read.
#include <zlib.h>

#include <cstring>

#include "core/error.hpp"
#include "core/media/image_codec.hpp"
#include "core/sequence/image_file.hpp"
#include "tests/fuzz/targets.hpp"

namespace stillpoint::fuzz {
namespace {

using Seeds = std::vector<std::string>;

std::string text_of(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

void decode(const std::string& name, Bytes bytes) {
  const ImageRead read = decode_image(name, std::move(bytes));
  if (!read.problem.empty()) throw InputError(read.problem);
}

cv::Mat example(int type) {
  cv::Mat image(6, 8, type);
  for (int y = 0; y < image.rows; ++y)
    for (std::size_t i = 0; i < static_cast<std::size_t>(image.cols) * image.elemSize(); ++i)
      image.ptr(y)[i] = static_cast<unsigned char>(y * 40 + static_cast<int>(i));
  return image;
}

constexpr std::size_t kSignature = 8, kChunkAround = 12;  // bytes: of the file; length, kind and checksum

/// With each chunk's checksum made right, which would keep all that is changed from the decoder.
Bytes with_checksums(std::string_view text) {
  Bytes bytes(text.begin(), text.end());
  if (bytes.size() < kSignature) bytes.resize(kSignature);
  std::memcpy(bytes.data(), "\x89PNG\r\n\x1A\n", kSignature);
  for (std::size_t at = kSignature; at + kChunkAround <= bytes.size();) {
    const auto big_endian = [&](std::size_t i) {
      return std::size_t{bytes[i]} << 24U | std::size_t{bytes[i + 1]} << 16U |
             std::size_t{bytes[i + 2]} << 8U | bytes[i + 3];
    };
    const std::size_t length = big_endian(at);
    if (length > bytes.size() - at - kChunkAround) break;
    const auto crc = ::crc32_z(0, bytes.data() + at + 4, length + 4);
    for (std::size_t i = 0; i < 4; ++i)
      bytes[at + 8 + length + i] = static_cast<unsigned char>(crc >> (24 - 8 * i));
    at += length + kChunkAround;
  }
  return bytes;
}

void read_png(std::string_view text) { decode("a.png", with_checksums(text)); }
Seeds png_seeds() {
  Seeds seeds;
  for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC3})
    seeds.push_back(text_of(encode_png(example(type), 6)));
  return seeds;
}

void read_jpeg(std::string_view text) {
  Bytes bytes(text.begin(), text.end());
  bytes.insert(bytes.begin(), {0xFF, 0xD8});
  bytes.insert(bytes.end(), {0xFF, 0xD9});  // one without its end goes no farther
  decode("a.jpg", std::move(bytes));
}
Seeds jpeg_seeds() {
  Seeds seeds;
  for (const int type : {CV_8UC1, CV_8UC3}) {
    const std::string whole = text_of(encode_jpeg(example(type), 90));
    seeds.push_back(whole.substr(2, whole.size() - 4));
  }
  return seeds;
}

}  // namespace

std::vector<Target> image_targets() {
  // A byte of deflate holds 1032 bytes of rows at most, which are 8 px each of three colours in a palette; a
  // byte of JPEG holds 512 px, whose coefficients a progressive one keeps.
  return {{"png", {1 << 20, 1032 * 8 * 3 + 2000}, read_png, png_seeds},
          {"jpeg", {1 << 20, 512 * 12}, read_jpeg, jpeg_seeds}};
}

}  // namespace stillpoint::fuzz
