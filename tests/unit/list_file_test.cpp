// Lists of stamps and names, and which entries of two belong together.
#include "core/sequence/list_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/sequence/association.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Association, TakesTheClosestPairFirst) {
  // The pair (0.010, 0.012) is closest and taken, so 0.000 is left with nothing else near.
  const auto pairs = associate({0.000, 0.010, 0.100}, {0.012, 0.105, 0.119});
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].first, 1U);
  EXPECT_EQ(pairs[0].second, 0U);
  EXPECT_NEAR(pairs[0].difference, -0.002, 1e-12);
  EXPECT_EQ(pairs[1].first, 2U);
  EXPECT_EQ(pairs[1].second, 1U);
}

TEST(Association, IsStrictlyCloserThanTheTolerance) {
  EXPECT_THAT(associate({0.0}, {0.25}, 0.25), IsEmpty());
  EXPECT_EQ(associate({0.0}, {0.25}, 0.2501).size(), 1U);
  EXPECT_THAT(associate({}, {1.0}), IsEmpty());
}

TEST(ListFile, NamesMayStandInQuotes) {
  std::vector<std::string> warnings;
  const auto entries = read_list(
      "rgb.csv", "timestamp,filename\n\"1.5\",\"rgb/1.png\"\n2.5,\"rgb/with blanks.png\"\n", warnings);
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].timestamp, 1.5);
  EXPECT_EQ(entries[0].file, "rgb/1.png");
  EXPECT_EQ(entries[1].file, "rgb/with blanks.png");
}

TEST(ListFile, ReadsNamesWithBlanksAndMendsOrder) {
  const TemporaryFolder folder;
  folder.write(
      "rgb.txt",
      "\xEF\xBB\xBF# c\r\n2.0 rgb/my image.png\r\n1.0\trgb/b#1.png # note\r\n\r\n2.0 rgb/again.png\r\n");
  std::vector<std::string> warnings;
  const auto entries = read_list(folder.path("rgb.txt"), warnings);
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0].file, "rgb/b#1.png");
  EXPECT_EQ(entries[0].line, 3);
  EXPECT_EQ(entries[1].file, "rgb/my image.png");
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("rgb.txt:3: the stamp is earlier"),
                                    HasSubstr("rgb.txt:5: the stamp was there")));
}

TEST(ListFile, TellsMalformedLines) {
  const TemporaryFolder folder;
  std::vector<std::string> warnings;
  const auto complaint = [&](const char* text) {
    folder.write("rgb.txt", text);
    return input_error_of([&] { (void)read_list(folder.path("rgb.txt"), warnings); });
  };
  EXPECT_THAT(complaint("1.0\n# x\n2.0 a.png\n"), HasSubstr("rgb.txt:1: found '1.0', expected"));
  EXPECT_THAT(complaint("one a.png\n"), HasSubstr("rgb.txt:1: found 'one' as a timestamp"));
  EXPECT_THAT(complaint("nan a.png\n"), HasSubstr("rgb.txt:1: found 'nan' as a timestamp"));
  EXPECT_THAT(complaint("# nothing\n"), HasSubstr("rgb.txt: names no images"));
  folder.write("associations.txt", "1 rgb/a.png 1\n");
  EXPECT_THAT(input_error_of([&] { (void)read_associations(folder.path("associations.txt"), warnings); }),
              HasSubstr("associations.txt:1: found 3 columns"));
}

TEST(ListFile, AssociationsTellTheirOrderByName) {
  const TemporaryFolder folder;
  std::vector<std::string> warnings;
  folder.write("a.txt", "1.5 depth/1.png 1.25 rgb/1.png\n");
  auto pairs = read_associations(folder.path("a.txt"), warnings);
  EXPECT_EQ(pairs.at(0).colour.file, "rgb/1.png");
  EXPECT_EQ(pairs.at(0).colour.timestamp, 1.25);
  folder.write("a.txt", "1.25 rgb/1.png 1.5 ./depth/1.png\n");
  pairs = read_associations(folder.path("a.txt"), warnings);
  EXPECT_EQ(pairs.at(0).depth.file, "./depth/1.png");
  EXPECT_EQ(pairs.at(0).depth.timestamp, 1.5);
}

}  // namespace
}  // namespace stillpoint
