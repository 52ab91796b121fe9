#include "core/media/png_filters.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <opencv2/core/hal/intrin.hpp>
#include <utility>
#include <vector>

namespace stillpoint {
namespace {

using Lanes = cv::v_uint8x16;

/// How a row tells what differs from the pixels left of it, above and above left.
enum class Filter : unsigned char { None, Sub, Up, Average, Paeth };

/// What Paeth chooses of the pixels left, above and above left: the one nearest to left + above - above left.
Lanes paeth(const Lanes& left, const Lanes& above, const Lanes& above_left) {
  const Lanes to_left = cv::v_absdiff(above, above_left), to_above = cv::v_absdiff(left, above_left);
  // The corner is the nearest only where it lies between the two others; the distance is their difference
  // then.
  const Lanes between = cv::v_max(cv::v_min(left, above), cv::v_min(cv::v_max(left, above), above_left));
  const Lanes to_corner = cv::v_absdiff(to_left, to_above) | ~(between == above_left);
  const Lanes not_left = cv::v_min(to_above, to_corner), nearest = cv::v_min(to_left, not_left);
  return cv::v_select(nearest == to_left, left, cv::v_select(not_left == to_above, above, above_left));
}

/// (left + above) / 2, rounded down.
Lanes average(const Lanes& left, const Lanes& above) {
  const Lanes half = cv::v_reinterpret_as_u8(cv::v_shr<1>(cv::v_reinterpret_as_u16(left ^ above)));
  return cv::v_add_wrap(left & above, half & cv::v_setall_u8(0x7F));
}

int paeth(int left, int above, int above_left) {
  const int to_left = std::abs(above - above_left), to_above = std::abs(left - above_left),
            to_corner = std::abs(left + above - 2 * above_left);
  if (to_left <= to_above && to_left <= to_corner) return left;
  return to_above <= to_corner ? above : above_left;
}

/// One row by itself. @param above the finished row above, zeros for the first @param pixel bytes a pixel
void undo_row(Filter filter, const unsigned char* in, const unsigned char* above, std::size_t pixel,
              std::size_t bytes, unsigned char* out) {
  const auto each = [&](const auto& predict) {
    for (std::size_t i = 0; i < pixel; ++i)
      out[i] = static_cast<unsigned char>(in[i] + predict(0, above[i], 0));
    for (std::size_t i = pixel; i < bytes; ++i)
      out[i] = static_cast<unsigned char>(in[i] + predict(out[i - pixel], above[i], above[i - pixel]));
  };
  switch (filter) {
    case Filter::None:
      std::memcpy(out, in, bytes);
      return;
    case Filter::Sub:
      return each([](int left, int, int) { return left; });
    case Filter::Up:
      return each([](int, int up, int) { return up; });
    case Filter::Average:
      return each([](int left, int up, int) { return (left + up) / 2; });
    case Filter::Paeth:
      return each([](int left, int up, int corner) { return paeth(left, up, corner); });
  }
}

/// Sixteen bytes as pixels of as many rows: a pixel of two bytes a lane, or of three or four.
template <int pixel_bytes>
struct Wave {
  using Lane = std::conditional_t<pixel_bytes == 2, std::uint16_t, std::uint32_t>;
  static constexpr std::size_t kRows = sizeof(Lanes) / sizeof(Lane);
  static constexpr std::size_t kSlack = kRows * sizeof(Lane);  // bytes touched before and behind a row

  static Lane load(const unsigned char* from) {
    Lane lane;
    std::memcpy(&lane, from, sizeof lane);
    return lane;
  }
  static auto typed(const Lanes& lanes) {
    if constexpr (pixel_bytes == 2)
      return cv::v_reinterpret_as_u16(lanes);
    else
      return cv::v_reinterpret_as_u32(lanes);
  }
  /// Of each row its own pixel: @param first the first row's @param step from a row's pixel to the next one's
  static Lanes gather(const unsigned char* first, std::ptrdiff_t step) {
    return [&]<std::size_t... row>(std::index_sequence<row...>) {
      return cv::v_reinterpret_as_u8(
          decltype(typed(Lanes()))(load(first + static_cast<std::ptrdiff_t>(row) * step)...));
    }
    (std::make_index_sequence<kRows>());
  }
  /// What the lane before holds, and in the first one a pixel of its own.
  static Lanes shift_in(const Lanes& lanes, const unsigned char* first) {
    auto one = typed(cv::v_setzero_u8());
    const Lane pixel = load(first);
    one = [&]<std::size_t... row>(std::index_sequence<row...>) {
      return decltype(one)((row == 0 ? pixel : Lane{0})...);
    }
    (std::make_index_sequence<kRows>());
    return cv::v_reinterpret_as_u8(cv::v_rotate_left<1>(typed(lanes)) | one);
  }
};

/// Rows that are undone together: where they are packed, and where they go, with room about each.
struct Rows {
  const unsigned char* in;     // the first one's pixels
  const unsigned char* above;  // the finished row above it
  unsigned char* out;          // the first one's pixels
  std::ptrdiff_t in_step, out_step;
  std::size_t bytes;  // a row
};

/// Which of the three neighbours each row's filter looks at: Paeth of them is then what the filter predicts.
template <int pixel_bytes>
std::array<Lanes, 3> neighbours_seen(const Rows& rows) {
  std::array<std::array<typename Wave<pixel_bytes>::Lane, Wave<pixel_bytes>::kRows>, 3> seen{};
  for (std::size_t r = 0; r < Wave<pixel_bytes>::kRows; ++r) {
    const auto filter = static_cast<Filter>(rows.in[static_cast<std::ptrdiff_t>(r) * rows.in_step - 1]);
    const auto all = static_cast<typename Wave<pixel_bytes>::Lane>(-1);
    if (filter == Filter::Sub || filter == Filter::Paeth) seen[0][r] = all;
    if (filter == Filter::Up || filter == Filter::Paeth) seen[1][r] = all;
    if (filter == Filter::Paeth) seen[2][r] = all;
  }
  std::array<Lanes, 3> masks;
  for (std::size_t k = 0; k < masks.size(); ++k)
    masks[k] = cv::v_load(reinterpret_cast<const unsigned char*>(seen[k].data()));
  return masks;
}

/// Undoes Wave::kRows rows. @param predict a row's pixels from those left, above and above left
template <int pixel_bytes, typename Predict>
void undo_wave(const Rows& rows, const Predict& predict) {
  using Of = Wave<pixel_bytes>;
  // A row's pixel lies one behind that of the row above it.
  const std::ptrdiff_t in_step = rows.in_step - pixel_bytes, out_step = rows.out_step - pixel_bytes;
  Lanes left = cv::v_setzero_u8(), corner = left;
  const auto step = [&](std::size_t x) {
    const Lanes above = Of::shift_in(left, rows.above + x);
    left = cv::v_add_wrap(Of::gather(rows.in + x, in_step), predict(left, above, corner));
    corner = above;
    alignas(16) std::array<typename Of::Lane, Of::kRows> pixels;
    cv::v_store_aligned(reinterpret_cast<unsigned char*>(pixels.data()), left);
    unsigned char* out = rows.out + x;
    for (const auto pixel : pixels) {
      std::memcpy(out, &pixel, sizeof pixel);
      out += out_step;
    }
  };
  std::size_t x = 0;
  for (std::size_t begun = 1; begun < Of::kRows; ++begun, x += pixel_bytes) {
    step(x);
    // Rows whose first pixel is yet to come have seen nothing so far.
    std::array<typename Of::Lane, Of::kRows> mask{};
    std::fill_n(mask.begin(), begun, static_cast<typename Of::Lane>(-1));
    left = left & cv::v_load(reinterpret_cast<const unsigned char*>(mask.data()));
  }
  for (const std::size_t end = rows.bytes + (Of::kRows - 1) * pixel_bytes; x < end; x += pixel_bytes) step(x);
}

/// Undoes as many rows together as there are lanes, where their filters allow it. @returns whether they did
template <int pixel_bytes>
bool undo_together(const Rows& rows) {
  std::size_t averages = 0, paeths = 0;
  for (std::size_t r = 0; r < Wave<pixel_bytes>::kRows; ++r) {
    const auto filter = static_cast<Filter>(rows.in[static_cast<std::ptrdiff_t>(r) * rows.in_step - 1]);
    averages += filter == Filter::Average;
    paeths += filter == Filter::Paeth;
  }
  if (averages == Wave<pixel_bytes>::kRows)
    undo_wave<pixel_bytes>(
        rows, [](const Lanes& left, const Lanes& above, const Lanes&) { return average(left, above); });
  else if (averages == 0 && paeths > 0)
    undo_wave<pixel_bytes>(rows, [seen = neighbours_seen<pixel_bytes>(rows)](
                                     const Lanes& left, const Lanes& above, const Lanes& corner) {
      return paeth(left & seen[0], above & seen[1], corner & seen[2]);
    });
  else
    return false;
  return true;
}

/// Undoes all rows.
template <int pixel_bytes>
void undo_rows(const unsigned char* packed, cv::Mat& image) {
  using Of = Wave<pixel_bytes>;
  const std::size_t bytes = static_cast<std::size_t>(image.cols) * pixel_bytes,
                    stride = bytes + 2 * Of::kSlack;
  std::vector<unsigned char> above(stride, 0), memory(stride * Of::kRows, 0);
  for (int y = 0; y < image.rows;) {
    const unsigned char* in = packed + static_cast<std::size_t>(y) * (bytes + 1) + 1;
    unsigned char* out = memory.data() + Of::kSlack;
    int count = static_cast<int>(Of::kRows);
    if (y + count > image.rows || !undo_together<pixel_bytes>({in, above.data() + Of::kSlack, out,
                                                               static_cast<std::ptrdiff_t>(bytes) + 1,
                                                               static_cast<std::ptrdiff_t>(stride), bytes})) {
      undo_row(static_cast<Filter>(in[-1]), in, above.data() + Of::kSlack, pixel_bytes, bytes, out);
      count = 1;
    }
    for (int k = 0; k < count; ++k, ++y)
      std::memcpy(image.ptr(y), out + static_cast<std::size_t>(k) * stride, bytes);
    std::memcpy(above.data() + Of::kSlack, image.ptr(y - 1), bytes);
  }
}

/// Undoes all rows one by one.
void undo_rows_singly(const unsigned char* packed, cv::Mat& image) {
  const std::size_t pixel = image.elemSize(), bytes = static_cast<std::size_t>(image.cols) * pixel;
  const std::vector<unsigned char> zeros(bytes, 0);
  for (int y = 0; y < image.rows; ++y, packed += bytes + 1)
    undo_row(static_cast<Filter>(*packed), packed + 1, y > 0 ? image.ptr(y - 1) : zeros.data(), pixel, bytes,
             image.ptr(y));
}

}  // namespace

bool undo_png_filters(const unsigned char* rows, cv::Mat& image) {
  const std::size_t bytes = static_cast<std::size_t>(image.cols) * image.elemSize();
  for (int y = 0; y < image.rows; ++y)
    if (rows[static_cast<std::size_t>(y) * (bytes + 1)] > static_cast<unsigned char>(Filter::Paeth))
      return false;
  switch (image.elemSize()) {
    case 2:
      undo_rows<2>(rows, image);
      break;
    case 3:
      undo_rows<3>(rows, image);
      break;
    case 4:
      undo_rows<4>(rows, image);
      break;
    default:
      undo_rows_singly(rows, image);
  }
  return true;
}

}  // namespace stillpoint
