// Outlines kept with a sequence's marks, carried to all its frames by the program.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/inspect/sidecar.hpp"
#include "core/sequence/fingerprint.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(OutlineCommand, MakesTrueMasksThatRunsAreScoredBy) {
  const SmallSequence sequence(8);
  expect_one_sentence(run_cli({"outline", sequence.path()}), "outlines are drawn in the window's panel");
  Marks marks;
  marks.drawn = {{1, {{{50, 50}, {149, 50}, {149, 149}, {50, 149}}}},
                 {6, {{{40, 50}, {139, 50}, {139, 149}, {40, 149}}}}};
  const auto source = open_sequence(sequence.path());
  write_marks(sequence.path("stillpoint.json"),
              {source->name(), sequence_fingerprint(*source), source->size()}, marks);
  const CliResult result = run_cli({"outline", sequence.path()});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("8 masks: 2 drawn, 6 carried"));
  // The wall slides by 2 px a frame, and what is drawn on it with it.
  const auto again = open_sequence(sequence.path());
  ASSERT_TRUE(again->has_masks());
  EXPECT_EQ(cv::countNonZero(again->truth(1).moving), 100 * 100);
  const cv::Mat carried = again->truth(3).moving;
  EXPECT_EQ(carried.at<uchar>(100, 48), 255);
  EXPECT_EQ(carried.at<uchar>(100, 40), 0);
  EXPECT_EQ(carried.at<uchar>(100, 155), 0);
  const CliResult run = run_cli({"run", sequence.path(), "--method", "oracle"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("IoU 100.0 %"));

  const CliResult elsewhere = run_cli({"outline", sequence.path(), "--out", sequence.path("masks")});
  ASSERT_EQ(elsewhere.exit_code, 0) << elsewhere.err;
  EXPECT_TRUE(fs::exists(sequence.path("masks/mask/000007.png")));
  expect_one_sentence(run_cli({"outline", "generated:room"}), "is no folder with outlines in it");
}

}  // namespace
}  // namespace stillpoint
