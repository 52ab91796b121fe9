#include "core/media/jpeg_codec.hpp"

#include <fmt/format.h>
#include <jerror.h>
#include <jpeglib.h>

#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/error.hpp"

namespace stillpoint {
namespace {

/// libjpeg tells of an error by a call that must not come back.
struct JpegErrors {
  jpeg_error_mgr base;  // first: libjpeg knows of this alone
  std::jmp_buf place;
  bool is_other = false;  // a kind that is left to OpenCV
  std::string refusal;    // why what it claims cannot be

  JpegErrors() {
    jpeg_std_error(&base);
    base.error_exit = [](j_common_ptr any) {
      std::longjmp(reinterpret_cast<JpegErrors*>(any->err)->place, 1);
    };
    base.output_message = [](j_common_ptr) {};
  }
};

constexpr JDIMENSION kLargestSide = 16384;  // px
// A block of 64 px takes a bit at least (ISO 10918-1, F.1.2), so that what is decoded is bounded by the file.
constexpr std::uint64_t kPixelsAByte = 64 * 8;
constexpr int kMostScans = 100;  // each goes through the whole image; encoders make ten

std::string refusal_of(const jpeg_decompress_struct& info, std::size_t bytes) {
  const std::uint64_t width = info.image_width, height = info.image_height;
  if (width > kLargestSide || height > kLargestSide)
    return fmt::format("it claims a size of {}x{} px, expected 1 to {} px a side", width, height,
                       kLargestSide);
  if (width * height > kPixelsAByte * bytes)
    return fmt::format("it claims {}x{} px, more than its {} bytes can hold", width, height, bytes);
  return {};
}

/// Ends the decoding of an image of too many scans.
void count_scans(j_common_ptr any) {
  if (reinterpret_cast<j_decompress_ptr>(any)->input_scan_number <= kMostScans) return;
  reinterpret_cast<JpegErrors*>(any->err)->refusal = fmt::format("it has more than {} scans", kMostScans);
  any->err->error_exit(any);
}

// What lies between setjmp and longjmp has nothing to clean up: images and buffers are the callers', and
// strings stay in functions of their own.

[[gnu::noinline]] bool is_refused(const jpeg_decompress_struct& info, std::size_t bytes, std::string& why) {
  why = refusal_of(info, bytes);
  return !why.empty();
}

bool decode_into(jpeg_decompress_struct& info, JpegErrors& errors, jpeg_progress_mgr& progress,
                 const std::vector<unsigned char>& bytes, cv::Mat& image) {
  if (setjmp(errors.place) != 0) {
    errors.is_other = errors.base.msg_code == JERR_NO_HUFF_TABLE;  // a camera's, which has the usual ones
    return false;
  }
  jpeg_create_decompress(&info);
  info.progress = &progress;
  jpeg_mem_src(&info, bytes.data(), bytes.size());
  jpeg_read_header(&info, TRUE);
  if (is_refused(info, bytes.size(), errors.refusal)) return false;
  const bool grey = info.jpeg_color_space == JCS_GRAYSCALE;
  errors.is_other = !grey && info.jpeg_color_space != JCS_YCbCr && info.jpeg_color_space != JCS_RGB;
  if (errors.is_other) return false;
  info.out_color_space = grey ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_start_decompress(&info);
  image.create(static_cast<int>(info.output_height), static_cast<int>(info.output_width),
               grey ? CV_8UC1 : CV_8UC3);
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = image.ptr(static_cast<int>(info.output_scanline));
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  return true;
}

bool encode_into(jpeg_compress_struct& info, JpegErrors& errors, const cv::Mat& image, int quality,
                 unsigned char*& buffer, unsigned long& size) {
  if (setjmp(errors.place) != 0) return false;
  jpeg_create_compress(&info);
  jpeg_mem_dest(&info, &buffer, &size);
  info.image_width = static_cast<JDIMENSION>(image.cols);
  info.image_height = static_cast<JDIMENSION>(image.rows);
  info.input_components = image.channels();
  info.in_color_space = image.channels() == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_set_defaults(&info);
  jpeg_set_quality(&info, quality, TRUE);
  jpeg_start_compress(&info, TRUE);
  while (info.next_scanline < info.image_height) {
    JSAMPROW row = const_cast<unsigned char*>(image.ptr(static_cast<int>(info.next_scanline)));
    jpeg_write_scanlines(&info, &row, 1);
  }
  jpeg_finish_compress(&info);
  return true;
}

}  // namespace

cv::Mat decode_plain_jpeg(const std::vector<unsigned char>& bytes, bool* is_damaged) {
  if (bytes.size() < 3 || bytes[0] != 0xFF || bytes[1] != 0xD8 || bytes[2] != 0xFF) return {};
  JpegErrors errors;
  jpeg_decompress_struct info{};
  info.err = &errors.base;
  jpeg_progress_mgr progress{};
  progress.progress_monitor = count_scans;
  cv::Mat image;
  const bool sound = decode_into(info, errors, progress, bytes, image);
  jpeg_destroy_decompress(&info);
  if (!errors.refusal.empty()) throw InputError(errors.refusal);
  if (is_damaged != nullptr) *is_damaged = !sound && !errors.is_other;
  return sound ? image : cv::Mat();
}

std::vector<unsigned char> encode_plain_jpeg(const cv::Mat& image, int quality) {
  if (image.empty() || (image.type() != CV_8UC1 && image.type() != CV_8UC3)) return {};
  JpegErrors errors;
  jpeg_compress_struct info{};
  info.err = &errors.base;
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  const bool written = encode_into(info, errors, image, quality, buffer, size);
  jpeg_destroy_compress(&info);
  std::vector<unsigned char> bytes;
  if (written) bytes.assign(buffer, buffer + size);
  std::free(buffer);
  return bytes;
}

}  // namespace stillpoint
