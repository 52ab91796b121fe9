#include "core/media/jpeg_codec.hpp"

#include <jpeglib.h>

#include <csetjmp>
#include <cstdio>
#include <cstdlib>

namespace stillpoint {
namespace {

/// libjpeg tells of an error by a call that must not come back.
struct JpegErrors {
  jpeg_error_mgr base;  // first: libjpeg knows of this alone
  std::jmp_buf place;

  JpegErrors() {
    jpeg_std_error(&base);
    base.error_exit = [](j_common_ptr any) {
      std::longjmp(reinterpret_cast<JpegErrors*>(any->err)->place, 1);
    };
    base.output_message = [](j_common_ptr) {};
  }
};

// What lies between setjmp and longjmp has nothing to clean up: images and buffers are the callers'.

bool decode_into(jpeg_decompress_struct& info, JpegErrors& errors, const std::vector<unsigned char>& bytes,
                 cv::Mat& image) {
  if (setjmp(errors.place) != 0) return false;
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, bytes.data(), bytes.size());
  jpeg_read_header(&info, TRUE);
  const bool grey = info.jpeg_color_space == JCS_GRAYSCALE;
  if (!grey && info.jpeg_color_space != JCS_YCbCr && info.jpeg_color_space != JCS_RGB) return false;
  info.out_color_space = grey ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_start_decompress(&info);
  image.create(static_cast<int>(info.output_height), static_cast<int>(info.output_width),
               grey ? CV_8UC1 : CV_8UC3);
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = image.ptr(static_cast<int>(info.output_scanline));
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  return errors.base.num_warnings == 0;
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

cv::Mat decode_plain_jpeg(const std::vector<unsigned char>& bytes) {
  if (bytes.size() < 3 || bytes[0] != 0xFF || bytes[1] != 0xD8 || bytes[2] != 0xFF) return {};
  JpegErrors errors;
  jpeg_decompress_struct info{};
  info.err = &errors.base;
  cv::Mat image;
  const bool sound = decode_into(info, errors, bytes, image);
  jpeg_destroy_decompress(&info);
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
