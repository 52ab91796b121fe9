#include "core/motion/paper/cleanup.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>
#include <vector>

#include "core/avx2.hpp"

namespace stillpoint {
namespace {

using Word = std::uint64_t;
constexpr int kWordBits = 64;  // pixels a word

/// The bytes of eight pixels by their bits: 255 where a bit is set.
const std::array<Word, 256>& bytes_of_bits() {
  static const std::array<Word, 256> bytes = [] {
    std::array<Word, 256> made{};
    for (std::size_t bits = 0; bits < made.size(); ++bits) {
      std::array<unsigned char, 8> eight{};
      for (std::size_t k = 0; k < eight.size(); ++k) eight[k] = (bits >> k & 1) != 0 ? 255 : 0;
      std::memcpy(&made[bits], eight.data(), eight.size());
    }
    return made;
  }();
  return bytes;
}

#if defined(__x86_64__)

constexpr int kWide = 32;  // pixels at once

/// Bits of 32 pixels of 0 or 255.
STILLPOINT_AVX2 Word bits_of_wide(const unsigned char* pixels) {
  return static_cast<std::uint32_t>(
      _mm256_movemask_epi8(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(pixels))));
}

/// @return how many bits it set, a multiple of 32
STILLPOINT_AVX2 int set_bits_wide(const unsigned char* pixels, int width, Word* bits) {
  int x = 0;
  for (; x + kWordBits <= width; x += kWordBits)
    bits[x / kWordBits] = bits_of_wide(pixels + x) | bits_of_wide(pixels + x + kWide) << kWide;
  if (x + kWide > width) return x;
  bits[x / kWordBits] = bits_of_wide(pixels + x);
  return x + kWide;
}

/// @return how many pixels it made
STILLPOINT_AVX2 int where_wide(const Word* bits, const unsigned char* usable, int width,
                               unsigned char* pixels) {
  const __m256i byte_of_pixel = _mm256_setr_epi8(0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1,  //
                                                 2, 2, 2, 2, 2, 2, 2, 2, 3, 3, 3, 3, 3, 3, 3, 3);
  const __m256i bit_of_pixel = _mm256_set1_epi64x(static_cast<long long>(0x8040201008040201U));
  int x = 0;
  for (; x + kWide <= width; x += kWide) {
    const auto own = static_cast<int>(bits[x / kWordBits] >> (x % kWordBits));
    const __m256i spread = _mm256_shuffle_epi8(_mm256_set1_epi32(own), byte_of_pixel);
    const __m256i set = _mm256_cmpeq_epi8(_mm256_and_si256(spread, bit_of_pixel), bit_of_pixel);
    const __m256i valid = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(usable + x));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(pixels + x), _mm256_and_si256(set, valid));
  }
  return x;
}

#endif

/// A mask with a bit a pixel: kernels of many pixels then take a few operations for 64 pixels at once.
class BitMask {
 public:
  /// @param mask CV_8UC1, 0 or 255
  BitMask(const cv::Mat& mask, bool wide)
      : wide_(wide),
        rows_(mask.rows),
        columns_(mask.cols),
        words_(static_cast<std::size_t>((mask.cols + kWordBits - 1) / kWordBits)),
        bits_(static_cast<std::size_t>(mask.rows) * words_, 0) {
    for (int y = 0; y < rows_; ++y) {
      const unsigned char* pixels = mask.ptr(y);
      Word* bits = row(y);
      int x = 0;
#if defined(__x86_64__)
      if (wide_) x = set_bits_wide(pixels, columns_, bits);
#endif
      for (; x + 16 <= columns_; x += 16) {
        const auto sixteen = cv::v_reinterpret_as_s8(cv::v_load(pixels + x));
        bits[x / kWordBits] |= static_cast<Word>(cv::v_signmask(sixteen)) << (x % kWordBits);
      }
      for (; x < columns_; ++x) bits[x / kWordBits] |= static_cast<Word>(pixels[x] >> 7) << (x % kWordBits);
    }
  }

  /// Sets what has a set pixel in a square around it. Pixels outside the image are not set.
  /// @param anchor where the pixel itself lies in the square, 0 to side - 1
  void dilate(int side, int anchor) {
    dilate_columns(side, anchor);
    dilate_rows(side, anchor);
  }

  /// Takes away what has a pixel in the square around it that is not set; those outside the image count as
  /// set.
  void erode(int side, int anchor) {
    invert();
    dilate(side, anchor);
    invert();
  }

  /// @param valid CV_8UC1, 0 or 255 @return CV_8UC1: 255 where both are set
  [[nodiscard]] cv::Mat where(const cv::Mat& valid) const {
    cv::Mat mask(rows_, columns_, CV_8UC1);
    const std::array<Word, 256>& bytes = bytes_of_bits();
    for (int y = 0; y < rows_; ++y) {
      const Word* bits = bits_.data() + static_cast<std::size_t>(y) * words_;
      const unsigned char* usable = valid.ptr(y);
      unsigned char* pixels = mask.ptr(y);
      int x = 0;
#if defined(__x86_64__)
      if (wide_) x = where_wide(bits, usable, columns_, pixels);
#endif
      for (; x + 8 <= columns_; x += 8) {
        Word eight = 0;
        std::memcpy(&eight, usable + x, 8);
        eight &= bytes[bits[x / kWordBits] >> (x % kWordBits) & 0xFF];
        std::memcpy(pixels + x, &eight, 8);
      }
      for (; x < columns_; ++x) pixels[x] = (bits[x / kWordBits] >> (x % kWordBits) & 1) != 0 ? usable[x] : 0;
    }
    return mask;
  }

 private:
  [[nodiscard]] Word* row(int y) { return bits_.data() + static_cast<std::size_t>(y) * words_; }

  void invert() {
    for (Word& word : bits_) word = ~word;
    clear_beyond_columns();
  }

  void dilate_columns(int side, int anchor) {
    // Rows that are not set above, for kernels that begin there.
    const std::size_t above = static_cast<std::size_t>(anchor) * words_;
    std::vector<Word> padded(above + bits_.size(), 0);
    std::copy(bits_.begin(), bits_.end(), padded.begin() + static_cast<std::ptrdiff_t>(above));
    for (int reach = 1; reach < side;) {  // a row tells of `reach` rows, itself the first
      const int step = std::min(reach, side - reach);
      const std::size_t ahead = static_cast<std::size_t>(step) * words_;
      for (std::size_t i = 0; i + ahead < padded.size(); ++i) padded[i] |= padded[i + ahead];
      reach += step;
    }
    std::copy_n(padded.begin(), bits_.size(), bits_.begin());
  }

  void dilate_rows(int side, int anchor) {
    // Words that are not set between the rows, for kernels that begin or end there.
    const auto room = static_cast<std::size_t>(side / kWordBits + 1);
    const std::size_t stride = words_ + room;
    std::vector<Word> padded(room + static_cast<std::size_t>(rows_) * stride + room, 0);
    for (int y = 0; y < rows_; ++y)
      std::copy_n(row(y), words_, padded.data() + room + static_cast<std::size_t>(y) * stride);
    for (int reach = 1; reach < side;) {  // a bit tells of `reach` pixels, itself the first
      const int step = std::min(reach, side - reach);
      const auto words = static_cast<std::size_t>(step / kWordBits);
      const int bits = step % kWordBits;
      for (std::size_t i = 0; i + words + 1 < padded.size(); ++i)
        padded[i] |= word_at(padded.data() + i + words, bits);
      reach += step;
    }
    const std::size_t shift = room * kWordBits - static_cast<std::size_t>(anchor);
    const int bits = static_cast<int>(shift % kWordBits);
    for (int y = 0; y < rows_; ++y) {
      const Word* from = padded.data() + static_cast<std::size_t>(y) * stride + shift / kWordBits;
      for (std::size_t w = 0; w < words_; ++w) row(y)[w] = word_at(from + w, bits);
    }
    clear_beyond_columns();
  }

  /// 64 bits that begin `shift` bits after those of a word, 0 to 63.
  static Word word_at(const Word* word, int shift) {
    return word[0] >> shift | word[1] << 1 << (kWordBits - 1 - shift);
  }

  void clear_beyond_columns() {
    const int rest = columns_ % kWordBits;
    if (rest == 0) return;
    for (int y = 0; y < rows_; ++y) row(y)[words_ - 1] &= (Word{1} << rest) - 1;
  }

  [[maybe_unused]] bool wide_;
  int rows_, columns_;
  std::size_t words_;
  std::vector<Word> bits_;
};

/// The side of the square that does at once what a smaller one does so many times.
int side_at_once(int side, int times) { return 1 + times * (side - 1); }

}  // namespace

cv::Mat clean_mask(const cv::Mat& raw_mask, const cv::Mat& valid, const PaperConfig& config, bool wide) {
  BitMask mask(raw_mask, wide);
  mask.erode(side_at_once(config.erode_kernel_px, config.erode_iterations),
             config.erode_iterations * (config.erode_kernel_px / 2));
  mask.dilate(side_at_once(config.dilate_kernel_px, config.dilate_iterations),
              config.dilate_iterations * ((config.dilate_kernel_px - 1) / 2));
  return mask.where(valid);
}

}  // namespace stillpoint
