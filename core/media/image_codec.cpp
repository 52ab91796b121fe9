#include "core/media/image_codec.hpp"

#include <spng.h>
#include <zlib.h>

#include <bit>
#include <cstring>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "core/error.hpp"
#include "core/media/jpeg_codec.hpp"
#include "core/media/media_module.hpp"
#include "core/media/png_decoder.hpp"
#include "core/media/png_encoder.hpp"
#include "core/out_folder.hpp"
#include "core/text_file.hpp"

namespace stillpoint {
namespace {

using Context = std::unique_ptr<spng_ctx, void (*)(spng_ctx*)>;

/// Swaps red and blue, which PNG and OpenCV have in opposite order.
void swap_colours(cv::Mat& image) {
  cv::Mat swapped;
  if (image.channels() == 3) cv::cvtColor(image, swapped, cv::COLOR_RGB2BGR);
  if (image.channels() == 4) cv::cvtColor(image, swapped, cv::COLOR_RGBA2BGRA);
  if (!swapped.empty()) image = swapped;
}

/// How a PNG's rows are made ready and packed.
struct Packing {
  int level;                             // zlib's, 1 to 9
  std::optional<int> filters, strategy;  // spng's choice of filters, zlib's strategy; nothing: spng's own
};

std::vector<unsigned char> encode(const cv::Mat& image, const Packing& packing) {
  const int channels = image.channels();
  if (image.empty() || image.depth() > CV_16U || image.depth() == CV_8S || channels == 2 || channels > 4)
    return {};
  cv::Mat pixels = image.isContinuous() ? image : image.clone();
  swap_colours(pixels);
  const Context context(spng_ctx_new(SPNG_CTX_ENCODER), spng_ctx_free);
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(image.cols);
  header.height = static_cast<std::uint32_t>(image.rows);
  header.bit_depth = image.depth() == CV_16U ? 16 : 8;
  header.color_type = channels == 1   ? SPNG_COLOR_TYPE_GRAYSCALE
                      : channels == 3 ? SPNG_COLOR_TYPE_TRUECOLOR
                                      : SPNG_COLOR_TYPE_TRUECOLOR_ALPHA;
  if (!context || spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1) != 0 ||
      spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, packing.level) != 0 ||
      (packing.strategy &&
       spng_set_option(context.get(), SPNG_IMG_COMPRESSION_STRATEGY, *packing.strategy) != 0) ||
      (packing.filters && spng_set_option(context.get(), SPNG_FILTER_CHOICE, *packing.filters) != 0) ||
      spng_set_ihdr(context.get(), &header) != 0 ||
      spng_encode_image(context.get(), pixels.data, pixels.total() * pixels.elemSize(), SPNG_FMT_PNG,
                        SPNG_ENCODE_FINALIZE) != 0)
    return {};
  int error = 0;
  std::size_t size = 0;
  const std::unique_ptr<void, void (*)(void*)> buffer(spng_get_png_buffer(context.get(), &size, &error),
                                                      std::free);
  if (!buffer || error != 0) return {};
  const auto* first = static_cast<const unsigned char*>(buffer.get());
  return {first, first + size};
}

}  // namespace

cv::Mat decode_pixels(const std::vector<unsigned char>& bytes) {
  cv::Mat image = decode_plain_png(bytes);
  // OpenCV's decoder of JPEGs is libjpeg as well, and would only print what is amiss.
  bool is_damaged = false;
  if (image.empty()) image = decode_plain_jpeg(bytes, &is_damaged);
  return image.empty() && !is_damaged ? media_module().decode(bytes) : image;
}

std::vector<unsigned char> encode_png(const cv::Mat& image, int level) {
  if (level > 1) return encode(image, {level, {}, {}});
  std::vector<unsigned char> plain = encode_plain_png(image);
  return plain.empty() ? encode(image, {1, SPNG_FILTER_CHOICE_SUB, {}}) : plain;
}

std::vector<unsigned char> encode_camera_png(const cv::Mat& image) {
  // Noise does not repeat itself, so that looking for what was there before is in vain. Depth in steps and
  // masks do, unless filters hide it.
  return encode(image, image.channels() == 1 ? Packing{1, SPNG_DISABLE_FILTERING, Z_DEFAULT_STRATEGY}
                                             : Packing{1, SPNG_FILTER_CHOICE_AVG, Z_RLE});
}

std::vector<unsigned char> encode_jpeg(const cv::Mat& image, int quality) {
  return encode_plain_jpeg(image, quality);
}

bool save_image(const std::filesystem::path& path, const cv::Mat& image, int png_level) {
  const std::string ending = lower_case(path.extension().string());
  constexpr int kJpegQuality = 95;  // OpenCV's own
  const std::vector<unsigned char> bytes = ending == ".png" ? encode_png(image, png_level)
                                           : ending == ".jpg" || ending == ".jpeg"
                                               ? encode_jpeg(image, kJpegQuality)
                                               : media_module().encode(ending, image, {});
  if (bytes.empty()) return false;
  try {
    write_text_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  } catch (const InputError&) {
    return false;
  }
  return true;
}

}  // namespace stillpoint
