#pragma once

#include <cstddef>
#include <opencv2/core.hpp>

namespace stillpoint {

/// Bytes past the last row that undo_png_filters may read.
constexpr std::size_t kPngRowSlack = 32;

/// Undoes the filters of a PNG's rows (ISO/IEC 15948, 9.2), several rows at a time where they look both left
/// and up: a row runs a pixel behind the one above it, so that what it needs of that one is there.
/// @param rows each behind the byte that names its filter, kPngRowSlack readable bytes behind the last
/// @param image continuous, its rows filled as PNG orders them: big-endian samples, red first
/// @returns false where a row names a filter that there is not
[[nodiscard]] bool undo_png_filters(const unsigned char* rows, cv::Mat& image);

}  // namespace stillpoint
