// What goes wrong in the middle of a sequence marks the frame it happens to, says why, and the run goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "tests/cli/csv_rows.hpp"
#include "tests/cli/run_cli.hpp"
#include "tests/cli/small_sequence.hpp"

namespace stillpoint {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr int kFrames = 8, kFault = 4;

struct Fault {
  const char* name;
  std::function<void(const SmallSequence&)> damage;  ///< of frame kFault
  const char* status;                                ///< that frame's
  const char* note;                                  ///< part of that frame's
};

void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

cv::Mat image(int type, double value, cv::Size size = {SmallSequence::kWidth, SmallSequence::kHeight}) {
  return {size, type, cv::Scalar::all(value)};
}

const std::vector<Fault> kFaults = {
    {"BlackColour", [](const SmallSequence& s) { s.folder.write(s.colour(kFault), image(CV_8UC3, 0)); },
     "lost", "0 of 0 features match the local map"},
    {"MissingColour", [](const SmallSequence& s) { std::filesystem::remove(s.path(s.colour(kFault))); },
     "unreadable", "rgb/4.png is missing"},
    {"TruncatedColour", [](const SmallSequence& s) { s.folder.truncate(s.colour(kFault), 0.5); },
     "unreadable", "rgb/4.png is truncated"},
    {"EmptyColour", [](const SmallSequence& s) { s.folder.write(s.colour(kFault), ""); }, "unreadable",
     "rgb/4.png is empty (0 bytes)"},
    {"ColourOfNoImage", [](const SmallSequence& s) { s.folder.write(s.colour(kFault), "no image"); },
     "unreadable", "rgb/4.png is no image that can be decoded"},
    {"ColourOfOtherSize",
     [](const SmallSequence& s) {
       s.folder.write(s.colour(kFault), image(CV_8UC3, 9, {64, 48}));
     },
     "unreadable", "rgb/4.png is 64x48 px, but the sequence's images are 320x240 px"},
    {"MissingDepth", [](const SmallSequence& s) { std::filesystem::remove(s.path(s.depth(kFault))); },
     "tracked", "depth/4.png is missing"},
    {"TruncatedDepth", [](const SmallSequence& s) { s.folder.truncate(s.depth(kFault), 0.5); }, "tracked",
     "depth/4.png is truncated"},
    {"EmptyDepth", [](const SmallSequence& s) { s.folder.write(s.depth(kFault), ""); }, "tracked",
     "depth/4.png is empty (0 bytes)"},
    {"ZeroDepth", [](const SmallSequence& s) { s.folder.write(s.depth(kFault), image(CV_16UC1, 0)); },
     "tracked", "depth/4.png is zero everywhere"},
    {"EightBitDepth", [](const SmallSequence& s) { s.folder.write(s.depth(kFault), image(CV_8UC1, 80)); },
     "tracked", "depth/4.png holds 1 channel of 8 bits, expected depth as 1 channel of 16 bits"},
    {"DepthOfOtherSize",
     [](const SmallSequence& s) {
       s.folder.write(s.depth(kFault), image(CV_16UC1, 7500, {64, 48}));
     },
     "tracked", "depth/4.png is 64x48 px, but its colour image is 320x240 px"},
};

class MidSequence : public ::testing::TestWithParam<std::tuple<const char*, Fault>> {};

TEST_P(MidSequence, MarksTheFrameAndGoesOn) {
  const auto& [method, fault] = GetParam();
  const SmallSequence sequence(kFrames);
  fault.damage(sequence);
  const CliResult result =
      run_cli({"run", sequence.path(), "--method", method, "--out", sequence.path("out")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  if (std::string(fault.status) == "unreadable") {
    EXPECT_THAT(result.out, ::testing::AllOf(HasSubstr("  no image "), HasSubstr(fault.note)));
  }

  const auto rows = csv_rows(sequence.folder.read("out/frames.csv"));
  ASSERT_EQ(rows.size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(rows[kFault].at("status"), fault.status);
  EXPECT_THAT(rows[kFault].at("note"), HasSubstr(fault.note));
  std::size_t estimated = 1;
  EXPECT_EQ(rows[0].at("status"), "initialised");
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows[i].at("status") == "tracked" || rows[i].at("status") == "relocalised") ++estimated;
    if (i != kFault) {
      EXPECT_THAT(rows[i].at("status"), AnyOf("tracked", "relocalised")) << "frame " << i;
      EXPECT_EQ(rows[i].at("note"), "") << "frame " << i;
    }
  }
  EXPECT_EQ(line_count(sequence.folder.read("out/trajectory.txt")), estimated);
}

INSTANTIATE_TEST_SUITE_P(Faults, MidSequence,
                         ::testing::Combine(::testing::Values("none", "paper", "stillpoint"),
                                            ::testing::ValuesIn(kFaults)),
                         [](const auto& tested) {
                           return std::string(std::get<1>(tested.param).name) + "_" +
                                  std::get<0>(tested.param);
                         });

class Frames : public ::testing::Test {
 protected:
  [[nodiscard]] static CliResult run(const SmallSequence& sequence) {
    return run_cli({"run", sequence.path(), "--method", "paper", "--out", sequence.path("out")});
  }
  [[nodiscard]] static std::vector<std::string> statuses(const SmallSequence& sequence) {
    std::vector<std::string> all;
    for (const auto& row : csv_rows(sequence.folder.read("out/frames.csv"))) all.push_back(row.at("status"));
    return all;
  }
};

TEST_F(Frames, ARunOfBlackFramesIsLostAndThenFoundAgain) {
  const SmallSequence sequence(12);
  for (int i = 5; i < 9; ++i) sequence.folder.write(sequence.colour(i), image(CV_8UC3, 0));
  EXPECT_EQ(run(sequence).exit_code, 0);
  const auto status = statuses(sequence);
  ASSERT_EQ(status.size(), 12U);
  for (std::size_t i = 5; i < 9; ++i) EXPECT_EQ(status[i], "lost") << i;
  EXPECT_EQ(status[9], "relocalised");
  EXPECT_EQ(status[10], "tracked");
  EXPECT_EQ(status[11], "tracked");
  EXPECT_EQ(line_count(sequence.folder.read("out/trajectory.txt")), 8U);
  EXPECT_THAT(sequence.folder.read("out/summary.json"), HasSubstr("\"lost_frames\": \"5-8\""));
}

TEST_F(Frames, AMapBeginsAtTheFirstFrameThatIsFit) {
  const SmallSequence sequence(6);
  sequence.folder.write(sequence.colour(0), image(CV_8UC3, 0));
  sequence.folder.write(sequence.depth(1), image(CV_16UC1, 0));
  EXPECT_EQ(run(sequence).exit_code, 0);
  EXPECT_THAT(statuses(sequence),
              ::testing::ElementsAre("lost", "lost", "initialised", "tracked", "tracked", "tracked"));
}

TEST_F(Frames, ADamagedLastFrameIsMarked) {
  const SmallSequence sequence(4);
  sequence.folder.write(sequence.colour(3), "");
  EXPECT_EQ(run(sequence).exit_code, 0);
  EXPECT_EQ(statuses(sequence).back(), "unreadable");
}

TEST_F(Frames, OneFrameIsASequence) {
  const SmallSequence sequence(1);
  const CliResult result = run(sequence);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(statuses(sequence), ::testing::ElementsAre("initialised"));
  EXPECT_EQ(line_count(sequence.folder.read("out/trajectory.txt")), 1U);
}

TEST_F(Frames, TwoFramesAreASequence) {
  const SmallSequence sequence(2);
  const CliResult result = run(sequence);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(statuses(sequence), ::testing::ElementsAre("initialised", "tracked"));
}

TEST_F(Frames, NoFrameThatCanBeTrackedIsAFailureThatKeepsItsData) {
  const SmallSequence sequence(3);
  for (int i = 0; i < 3; ++i) sequence.folder.write(sequence.colour(i), image(CV_8UC3, 0));
  const CliResult result = run(sequence);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("no frame could be tracked (only 0 features with depth"));
  EXPECT_THAT(statuses(sequence), ::testing::ElementsAre("lost", "lost", "lost"));
  EXPECT_EQ(sequence.folder.read("out/trajectory.txt"), "");
}

TEST_F(Frames, DepthOfAWrongKindThroughoutIsAFailureThatSaysSo) {
  const SmallSequence sequence(3);
  for (int i = 0; i < 3; ++i) sequence.folder.write(sequence.depth(i), image(CV_8UC1, 80));
  const CliResult result = run(sequence);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err,
              HasSubstr("depth/0.png holds 1 channel of 8 bits, expected depth as 1 channel of 16 bits"));
}

TEST_F(Frames, UnsortedAndRepeatedStampsAreMendedWithAWarning) {
  const SmallSequence sequence(4);
  std::string list;
  for (const int i : {0, 2, 1, 1, 3})
    list += fmt::format("{:.4f} {}\n", sequence.stamp(i), sequence.colour(i));
  sequence.folder.write("rgb.txt", list);
  const CliResult result = run(sequence);
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.err, HasSubstr("warning: "));
  EXPECT_THAT(result.err, HasSubstr("rgb.txt:3: "));
  EXPECT_THAT(result.err, HasSubstr("rgb.txt:4: "));
  EXPECT_THAT(statuses(sequence), ::testing::ElementsAre("initialised", "tracked", "tracked", "tracked"));
  const auto rows = csv_rows(sequence.folder.read("out/frames.csv"));
  EXPECT_LT(std::stod(rows[1].at("timestamp_s")), std::stod(rows[2].at("timestamp_s")));
}

TEST_F(Frames, TheBenchmarkGoesOnToo) {
  const SmallSequence sequence(kFrames);
  std::filesystem::remove(sequence.path(sequence.colour(kFault)));
  const CliResult result =
      run_cli({"benchmark", sequence.path(), "--methods", "none,paper", "--out", sequence.path("out")});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto rows = csv_rows(sequence.folder.read("out/details.csv"));
  ASSERT_EQ(rows.size(), 2U);
  for (const auto& row : rows) EXPECT_EQ(row.at("coverage %"), "87.5");
  for (const char* method : {"none", "paper"}) {
    const auto frames = csv_rows(sequence.folder.read(std::string("out/sequence/") + method + "/frames.csv"));
    ASSERT_EQ(frames.size(), static_cast<std::size_t>(kFrames));
    EXPECT_EQ(frames[kFault].at("status"), "unreadable");
  }
}

TEST(FramesWithoutDepth, EveryReasonIsToldWithItsFrames) {
  const SmallSequence sequence(8);
  std::string depths;
  for (int i = 0; i < 8; ++i)
    if (i != 2) depths += fmt::format("{:.4f} {}\n", SmallSequence::stamp(i), SmallSequence::depth(i));
  sequence.folder.write("depth.txt", depths);
  for (const int i : {4, 6})
    sequence.folder.write(SmallSequence::depth(i),
                          cv::Mat(SmallSequence::kHeight, SmallSequence::kWidth, CV_8UC1, cv::Scalar(75)));
  const CliResult result = run_cli({"run", sequence.path(), "--method", "none"});
  EXPECT_THAT(result.out, ::testing::HasSubstr("3 of 8 frames: 2 (no depth image within 0.02 s); 4, 6 ("));
  EXPECT_THAT(result.out, ::testing::HasSubstr("8 bits"));
}

}  // namespace
}  // namespace stillpoint
