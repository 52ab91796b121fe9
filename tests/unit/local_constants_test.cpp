// A number with a name says its unit and why it is this one, in a comment: on its line, directly above, or
// above the block of constants that it stands in.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/places.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;

struct Constants {
  int numbers = 0;                ///< constants that hold a number
  std::vector<std::string> bare;  ///< those without a comment, by line
};

std::string without_comment(const std::string& line) { return line.substr(0, line.find("//")); }

bool is_comment(const std::string& line) {
  const std::size_t at = line.find_first_not_of(' ');
  return at != std::string::npos && line.compare(at, 2, "//") == 0;
}

/// Whether what a constant is set to holds a number of its own, beside other constants and names.
bool holds_number(const std::string& value) {
  char before = ' ';
  bool in_name = false, in_text = false;
  for (const char c : value) {
    if (c == '"' && before != '\\') in_text = !in_text;
    const bool digit = std::isdigit(static_cast<unsigned char>(c)) != 0,
               letter = std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
    if (digit && !in_name && !in_text) return true;
    in_name = letter || (digit && in_name);
    before = c;
  }
  return false;
}

Constants constants_of(const std::vector<std::string>& lines) {
  static const std::regex kDeclared(
      R"(^\s*(inline |static )*(constexpr|const) (unsigned char|unsigned|int|long|float|double|auto|std::size_t|std::u?int\d+_t|std::ptrdiff_t|(Eigen::)?Vector\d[dfi]|cv::(Point\w*|TermCriteria|Size|Scalar|Vec\w+)|std::array<.*>)\s+(k[A-Z]\w*)\s*(\[[^\]]*\])?\s*[=({])");
  Constants found;
  bool headed = false;   // by a comment above the block
  std::size_t next = 0;  // line after the last constant
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch parts;
    if (lines[i].find("const") == std::string::npos || !std::regex_search(lines[i], parts, kDeclared))
      continue;
    std::string value =
        without_comment(lines[i]).substr(static_cast<std::size_t>(parts.position(6) + parts.length(6)));
    bool commented = lines[i].find("//") != std::string::npos;
    std::size_t end = i;
    while (value.find(';') == std::string::npos && end + 1 < lines.size()) {
      ++end;
      value += without_comment(lines[end]);
      commented = commented || lines[end].find("//") != std::string::npos;
    }
    const bool above = i > 0 && is_comment(lines[i - 1]);
    headed = above || (headed && i == next);
    next = end + 1;
    if (!holds_number(value)) continue;
    ++found.numbers;
    if (!commented && !headed) found.bare.push_back(std::to_string(i + 1) + ": " + parts[6].str());
    i = end;
  }
  return found;
}

std::vector<std::string> bare_in(std::vector<std::string> lines) { return constants_of(lines).bare; }

TEST(LocalConstants, ANumberWithoutACommentIsFound) {
  EXPECT_THAT(bare_in({"constexpr double kFar = 2.0;"}), ::testing::ElementsAre("1: kFar"));
  EXPECT_THAT(bare_in({"  static constexpr std::size_t kSides[] = {", "    4,", "};"}),
              ::testing::ElementsAre("1: kSides"));
  EXPECT_THAT(bare_in({"const cv::Point2f kHalf(0.5F, kOther);"}), ::testing::ElementsAre("1: kHalf"));
  EXPECT_THAT(bare_in({"// About something else.", "", "constexpr int kRounds = 3;"}),
              ::testing::ElementsAre("3: kRounds"));
  EXPECT_THAT(
      bare_in({"// Heads the first.", "constexpr int kA = 3;", "int b = 0;", "constexpr int kC = 3;"}),
      ::testing::ElementsAre("4: kC"));
}

TEST(LocalConstants, ACommentCountsOnItsLinesAboveOrAboveTheBlock) {
  EXPECT_THAT(bare_in({"constexpr double kFar = 2.0;  // m: …"}), ::testing::IsEmpty());
  EXPECT_THAT(bare_in({"constexpr double kFar =", "    2.0;  // m: …"}), ::testing::IsEmpty());
  EXPECT_THAT(bare_in({"// Why.", "constexpr int kA = 1;", "constexpr int kB = 2;"}), ::testing::IsEmpty());
}

TEST(LocalConstants, WhatHoldsNoNumberOfItsOwnNeedsNone) {
  EXPECT_EQ(constants_of({"constexpr int kPixels = kSide2 * kSide2;"}).numbers, 0);
  EXPECT_EQ(constants_of({"constexpr float kNone = std::numeric_limits<float>::quiet_NaN();"}).numbers, 0);
  EXPECT_EQ(constants_of({"constexpr const char* kName = \"frame 2\";"}).numbers, 0);
  EXPECT_EQ(constants_of({"const bool sweep = plan.handling == Handling::kSweep;"}).numbers, 0);
}

TEST(LocalConstants, AllOfCoreSayWhy) {
  int numbers = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(places::source()) / "core")) {
    const std::string ending = entry.path().extension().string();
    if (ending != ".cpp" && ending != ".hpp") continue;
    std::ifstream file(entry.path());
    std::vector<std::string> lines;
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    const Constants found = constants_of(lines);
    numbers += found.numbers;
    EXPECT_THAT(found.bare, ::testing::IsEmpty())
        << fs::relative(entry.path(), places::source()).string()
        << ": say its unit and why it has this value, or do without the name";
  }
  EXPECT_GT(numbers, 500);
}

}  // namespace
}  // namespace stillpoint
