#include "core/text_file.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> texts_of(const std::vector<TextLine>& lines) {
  std::vector<std::string> texts;
  for (const TextLine& line : lines) texts.push_back(std::to_string(line.number) + " " + line.text);
  return texts;
}

/// A text as Windows' shells write it, its code units given. @param big_endian the higher byte first
std::string utf16(const std::u16string& units, bool big_endian) {
  std::string bytes;
  for (const char16_t unit : u"\uFEFF" + units) {
    const char low = static_cast<char>(unit & 0xFF), high = static_cast<char>(unit >> 8);
    bytes += big_endian ? std::string{high, low} : std::string{low, high};
  }
  return bytes;
}

TEST(TextFile, EveryLineEndEndsALine) {
  const auto two = ElementsAre("1 1 a.png", "2 2 b.png");
  EXPECT_THAT(texts_of(text_lines("1 a.png\n2 b.png\n")), two);
  EXPECT_THAT(texts_of(text_lines("1 a.png\r\n2 b.png\r\n")), two);
  EXPECT_THAT(texts_of(text_lines("1 a.png\r2 b.png\r")), two);
  EXPECT_THAT(texts_of(text_lines("1 a.png\r2 b.png")), two);
  // Lines are counted as editors count them where a CR stands beside LF by mistake.
  EXPECT_THAT(texts_of(text_lines("1 a.png\r\r\n2 b.png\r\r\n")), two);
}

TEST(TextFile, QuotesAboutCellsAreNoPartOfThem) {
  EXPECT_EQ(split_columns("\"1.5\",\"rgb/1.png\""), (std::vector<std::string_view>{"1.5", "rgb/1.png"}));
  EXPECT_EQ(split_columns("\"1,5\" \""), (std::vector<std::string_view>{"\"1", "5\"", "\""}));
}

TEST(TextFile, Utf16WithAByteOrderMarkIsRead) {
  for (const bool big_endian : {false, true}) {
    EXPECT_THAT(texts_of(text_lines(utf16(u"# head\r\n1.5 rgb/a.png\r\n2 b\r\n", big_endian))),
                ElementsAre("2 1.5 rgb/a.png", "3 2 b"));
    // Of one, two, three and four bytes in UTF-8.
    EXPECT_THAT(texts_of(text_lines(utf16(u"a\u00FC\u20AC\U0001F600", big_endian))),
                ElementsAre("1 a\xC3\xBC\xE2\x82\xAC\xF0\x9F\x98\x80"));
  }
  std::string cut = utf16(u"1 a", false);
  EXPECT_THAT(texts_of(text_lines(cut.substr(0, cut.size() - 1))), ElementsAre("1 1"));
}

TEST(TextFile, AFileWithoutEndIsRefused) {
  constexpr std::size_t kMost = 3 << 20;
  EXPECT_THAT(input_error_of([] { (void)read_text("/dev/zero", kMost); }),
              HasSubstr("/dev/zero: holds more than 3 MB, expected a text file"));
  const TemporaryFolder folder;
  const std::string text(kMost, 'x');
  folder.write("whole.txt", text);
  EXPECT_EQ(read_text(folder.path("whole.txt"), kMost), text);
}

TEST(TextFile, StampsHaveAnEnd) {
  EXPECT_TRUE(is_stamp(1.7e18));  // today in nanoseconds
  EXPECT_TRUE(is_stamp(-5.0));
  for (const double none : {1e300, -1e20, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_FALSE(is_stamp(none)) << none;
}

}  // namespace
}  // namespace stillpoint
