#pragma once

#include <gtest/gtest.h>

#include <cstring>

#include "core/motion/stage_log.hpp"

namespace stillpoint {

/// Whether two images have the same bytes, those of unknown values too.
inline bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int y = 0; y < a.rows; ++y)
    if (std::memcmp(a.ptr(y), b.ptr(y), a.elemSize() * static_cast<std::size_t>(a.cols)) != 0) return false;
  return true;
}

/// Expects the same stages, with every image and figure the same to the bit.
inline void expect_same_stages(const StageLog& a, const StageLog& b) {
  ASSERT_EQ(a.stages.size(), b.stages.size());
  for (std::size_t i = 0; i < a.stages.size(); ++i) {
    const Stage &one = a.stages[i], &other = b.stages[i];
    EXPECT_TRUE(one.same_place(other)) << one.id;
    ASSERT_EQ(one.sides.size(), other.sides.size()) << one.id;
    for (std::size_t k = 0; k < one.sides.size(); ++k)
      EXPECT_TRUE(same_bytes(one.sides[k].output.image, other.sides[k].output.image)) << one.id;
    ASSERT_EQ(one.figures.size(), other.figures.size()) << one.id;
    for (std::size_t k = 0; k < one.figures.size(); ++k)
      EXPECT_EQ(one.figures[k].value, other.figures[k].value) << one.id << ": " << one.figures[k].name;
  }
}

}  // namespace stillpoint
