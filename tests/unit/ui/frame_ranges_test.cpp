#include "core/inspect/frame_ranges.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string complaint(const std::string& text, int count = 50) {
  try {
    (void)parse_frame_ranges(text, count);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FrameRanges, AreReadAsWritten) {
  EXPECT_THAT(parse_frame_ranges("10", 50), ElementsAre(10));
  EXPECT_THAT(parse_frame_ranges("10,20:40:5", 50), ElementsAre(10, 20, 25, 30, 35));
  EXPECT_THAT(parse_frame_ranges("-1", 50), ElementsAre(49));
  EXPECT_THAT(parse_frame_ranges(":3", 50), ElementsAre(0, 1, 2));
  EXPECT_THAT(parse_frame_ranges("47:", 50), ElementsAre(47, 48, 49));
  EXPECT_THAT(parse_frame_ranges("-3:-1", 50), ElementsAre(47, 48));
  EXPECT_THAT(parse_frame_ranges("48:1000", 50), ElementsAre(48, 49));
}

TEST(FrameRanges, EachFrameOnceAndInOrder) {
  EXPECT_THAT(parse_frame_ranges("7,5:8,6", 50), ElementsAre(5, 6, 7));
}

TEST(FrameRanges, SayWhatIsWrong) {
  EXPECT_THAT(complaint("50"), HasSubstr("frames 0 to 49"));
  EXPECT_THAT(complaint("-51"), HasSubstr("frames 0 to 49"));
  EXPECT_THAT(complaint("60:70"), HasSubstr("none of the frames 0 to 49"));
  EXPECT_THAT(complaint("5:5"), HasSubstr("none of the frames"));
  for (const char* text : {"", "x", "1,,2", "1:2:3:4", "1:9:0", "1:9:-1", "1.5", "99999999999", " 1"})
    EXPECT_THAT(complaint(text), HasSubstr("expected frames like")) << text;
}

TEST(Size, IsReadAsWritten) {
  EXPECT_EQ(parse_size("1600x900"), std::pair(1600, 900));
  for (const char* text :
       {"", "1600", "1600x", "x900", "1600x900x3", "15x900", "1600x20000", "-1600x900", "axb"})
    EXPECT_THROW((void)parse_size(text), InputError) << text;
}

TEST(List, IsSplitAtCommas) {
  EXPECT_THAT(split_list("a, b ,c"), ElementsAre("a", "b", "c"));
  EXPECT_THAT(split_list(" , "), ElementsAre());
}

TEST(List, OfNamesMayHoldACommaInAName) {
  EXPECT_THAT(split_names(R"(left\,right, paper ,a\b)"), ElementsAre("left,right", "paper", R"(a\b)"));
  EXPECT_THAT(split_names(" , "), ElementsAre());
}

TEST(FrameRanges, AStepBeyondAllFramesLeavesTheFirst) {
  EXPECT_THAT(parse_frame_ranges("3:5:2147483647", 8), ElementsAre(3));
  EXPECT_THAT(parse_frame_ranges("0:8:7", 8), ElementsAre(0, 7));
}

}  // namespace
}  // namespace stillpoint
