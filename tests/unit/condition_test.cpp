#include "core/run/condition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/evaluation/trajectory_metrics.hpp"
#include "core/odometry/frame_record.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Ten frames: frame i has 10 i inliers of 100 matches and a mask of i %; 3 and 4 are lost.
std::vector<FrameRecord> ten_records() {
  std::vector<FrameRecord> records(10);
  for (int i = 0; i < 10; ++i) {
    FrameRecord& r = records[static_cast<std::size_t>(i)];
    r.index = i;
    r.timestamp = 0.1 * i;
    r.status = i == 3 || i == 4 ? FrameStatus::lost : FrameStatus::tracked;
    r.estimated = r.status == FrameStatus::tracked;
    r.inliers = 10 * i;
    r.matches = 100;
    r.mask_share = 0.01 * i;
    r.rms_px = 0.5 * i;
    r.ms.total = 20.0;
    r.keyframe = i % 4 == 0;
  }
  return records;
}

std::vector<int> where(std::string_view text, const std::vector<FrameRecord>& records = ten_records()) {
  return Condition(text).frames(FrameFigures({records}));
}

TEST(Condition, ComparesWhatIsRecorded) {
  EXPECT_THAT(where("inliers < 20"), ElementsAre(0, 1));
  EXPECT_THAT(where("inliers <= 20"), ElementsAre(0, 1, 2));
  EXPECT_THAT(where("inliers == 70"), ElementsAre(7));
  EXPECT_THAT(where("inliers != 100 && frame >= 8"), ElementsAre(8, 9));
  EXPECT_THAT(where("80 < inliers"), ElementsAre(9));
}

TEST(Condition, TellsWhatNoFrameHas) {
  const std::vector<FrameRecord> ten = ten_records(), none;
  const FrameFigures figures({ten});
  const Condition condition("rpe > 2 cm || mask_iou < 50% || inliers < 20 || residual > 1");
  EXPECT_THAT(condition.unknown_figures(figures), ElementsAre("rpe", "mask_iou"));
  EXPECT_THAT(Condition("inliers < 20").unknown_figures(figures), IsEmpty());
  EXPECT_THAT(condition.unknown_figures(FrameFigures({none})), IsEmpty());
}

TEST(Condition, KnowsStatesAndTheirOpposites) {
  EXPECT_THAT(where("lost"), ElementsAre(3, 4));
  EXPECT_THAT(where("keyframe"), ElementsAre(0, 4, 8));
  EXPECT_THAT(where("!tracked"), ElementsAre(3, 4));
  EXPECT_THAT(where("not tracked or frame == 9"), ElementsAre(3, 4, 9));
}

TEST(Condition, AndBindsTighterThanOrAndProductsTighterThanSums) {
  EXPECT_THAT(where("frame == 1 || frame > 3 && frame < 6"), ElementsAre(1, 4, 5));
  EXPECT_THAT(where("(frame == 1 || frame > 3) && frame < 6"), ElementsAre(1, 4, 5));
  EXPECT_THAT(where("(frame == 7 || frame > 3) && frame < 6"), ElementsAre(4, 5));
  EXPECT_THAT(where("frame + 2 * 3 == 10"), ElementsAre(4));
  EXPECT_THAT(where("(frame + 2) * 3 == 18"), ElementsAre(4));
  EXPECT_THAT(where("frame - 1 - 1 == 3"), ElementsAre(5));
  EXPECT_THAT(where("-frame == -6"), ElementsAre(6));
}

TEST(Condition, TakesUnits) {
  EXPECT_THAT(where("mask > 7.5 %"), ElementsAre(8, 9));
  EXPECT_THAT(where("mask > 0.075"), ElementsAre(8, 9));
  EXPECT_THAT(where("residual >= 4px"), ElementsAre(8, 9));
  EXPECT_EQ(where("ms.total > 0.01 s").size(), 10U);
  EXPECT_THAT(where("ms.total > 0.03 s"), IsEmpty());
  EXPECT_THAT(where("inliers / matches > 75%"), ElementsAre(8, 9));
}

TEST(Condition, LooksAtTheFrameBefore) {
  EXPECT_THAT(where("previous(lost)"), ElementsAre(4, 5));
  EXPECT_THAT(where("lost && !previous(lost)"), ElementsAre(3));
  EXPECT_EQ(where("change(inliers) == 10").size(), 9U);  // there is none before the first
  EXPECT_THAT(where("abs(frame - 5) < 2"), ElementsAre(4, 5, 6));
}

TEST(Condition, WhatIsNotKnownMakesComparisonsFalse) {
  EXPECT_THAT(where("rpe > 0"), IsEmpty());
  EXPECT_THAT(where("rpe <= 0"), IsEmpty());
  EXPECT_THAT(where("rpe != 0"), IsEmpty());
  EXPECT_THAT(where("rpe"), IsEmpty());
  // A lost frame has no residual, though its record holds a number.
  // … nor has one without inliers, the first here.
  EXPECT_THAT(where("residual < 2.2 px"), ElementsAre(1, 2));
  EXPECT_THAT(where("inliers / (frame - frame) > 0"), IsEmpty());
}

TEST(Condition, NorDoesTheOppositeHoldOfWhatIsNotKnown) {
  EXPECT_THAT(where("!(rpe > 0)"), IsEmpty());
  EXPECT_THAT(where("!rpe"), IsEmpty());
  EXPECT_THAT(where("!!(rpe > 0)"), IsEmpty());
  EXPECT_THAT(where("!(rpe > 0 || lost)"), IsEmpty());
  // What is known decides where it can.
  EXPECT_THAT(where("rpe > 0 || lost"), ElementsAre(3, 4));
  EXPECT_THAT(where("!(rpe > 0 && lost)"), ElementsAre(0, 1, 2, 5, 6, 7, 8, 9));
  // Before the first frame nothing was lost.
  std::vector<FrameRecord> records = ten_records();
  records[0].status = FrameStatus::lost;
  EXPECT_THAT(where("lost && !previous(lost)", records), ElementsAre(0, 3));
}

TEST(Condition, AFigureThatNobodyMeasuredIsNotKnown) {
  std::vector<FrameRecord> records = ten_records();
  for (FrameRecord& record : records) record.measured.matches = record.index >= 5;
  EXPECT_THAT(where("inliers < 70", records), ElementsAre(5, 6));
  EXPECT_THAT(where("!(inliers < 70)", records), ElementsAre(7, 8, 9));
}

TEST(Condition, ReadsErrorsFromTheEvaluation) {
  TrajectoryEvaluation evaluation;
  evaluation.rpe_frame.errors = {
      {.from_timestamp = 0.4, .to_timestamp = 0.5, .translation_m = 0.04, .rotation_deg = 2}};
  evaluation.rpe_time.errors = {
      {.from_timestamp = 0.0, .to_timestamp = 0.6, .translation_m = 0.07, .rotation_deg = 1}};
  evaluation.ate.errors = {{.timestamp = 0.7, .translation_m = 0.3, .rotation_deg = 0}};
  auto records = ten_records();
  records[5].timestamp = 0.5, records[6].timestamp = 0.6, records[7].timestamp = 0.7;
  const FrameFigures figures({records, &evaluation});
  EXPECT_THAT(Condition("rpe > 3 cm").frames(figures), ElementsAre(5));
  EXPECT_THAT(Condition("rpe > 45 mm").frames(figures), IsEmpty());
  EXPECT_THAT(Condition("rpe_deg > 1 deg").frames(figures), ElementsAre(5));
  EXPECT_THAT(Condition("rpe_1s > 0.05").frames(figures), ElementsAre(6));
  EXPECT_THAT(Condition("ate >= 0.3 m").frames(figures), ElementsAre(7));
}

TEST(Condition, FindsSpikesAgainstTheFramesBefore) {
  std::vector<FrameRecord> records(40);
  for (int i = 0; i < 40; ++i) {
    FrameRecord& r = records[static_cast<std::size_t>(i)];
    r.index = i;
    r.inliers = 100 + (i % 3 - 1);  // 99, 100, 101: the median deviation is 1, a sigma 1.4826
  }
  records[30].inliers = 106;
  records[35].inliers = 104;
  EXPECT_THAT(where("spike(inliers, 3)", records), ElementsAre(30));
  EXPECT_THAT(where("spike(inliers, 2.5)", records), ElementsAre(30, 35));
  // Too few frames before say nothing.
  records[4].inliers = 500;
  EXPECT_THAT(where("spike(inliers, 3)", records), ElementsAre(30));
}

struct Wrong {
  const char* text;
  int column;
  const char* why;
};

/// What the test is called by.
void PrintTo(const Wrong& wrong, std::ostream* to) { *to << wrong.why; }

class WrongCondition : public ::testing::TestWithParam<Wrong> {};

TEST_P(WrongCondition, IsAnsweredAtThePlace) {
  try {
    (void)Condition(GetParam().text);
    FAIL() << "was taken: " << GetParam().text;
  } catch (const ConditionError& error) {
    EXPECT_EQ(error.column(), GetParam().column) << error.what();
    EXPECT_THAT(error.what(), HasSubstr(GetParam().why));
    EXPECT_THAT(error.what(), HasSubstr("column " + std::to_string(GetParam().column + 1)));
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, WrongCondition,
    ::testing::Values(Wrong{"", 0, "no condition"}, Wrong{"   ", 0, "no condition"},
                      Wrong{"inliners < 3", 0, "did you mean inliers?"},
                      Wrong{"lost || rpe > 3 apples", 16, "no unit"}, Wrong{"rpe >", 5, "it ends where"},
                      Wrong{"rpe > 3 px", 4, "in m, right of it one that is in px"},
                      Wrong{"mask > 3 mm", 5, "a share"}, Wrong{"rpe + inliers > 2", 4, "a plain number"},
                      Wrong{"(lost", 5, ") for the ("}, Wrong{"lost)", 4, "&&, || or the end"},
                      Wrong{"rpe = 3", 4, "=="}, Wrong{"1 < frame < 3", 10, "one comparison at a time"},
                      Wrong{"lost & keyframe", 5, "not understood"}, Wrong{"spike(rpe)", 9, "comma"},
                      Wrong{"spike(rpe, x)", 11, "number"}, Wrong{"sqrt(rpe) > 1", 0, "no function"},
                      Wrong{"lost keyframe", 5, "&&, || or the end"}, Wrong{"frame > 1e999", 8, "too large"},
                      Wrong{"spike(spike(rpe, 3), 3)", 6, "spike of a spike"}));

TEST(ConditionLimits, HostileTextsAreRefused) {
  EXPECT_THROW((void)Condition(std::string(1500, '(')), ConditionError);
  EXPECT_THROW((void)Condition(std::string(1500, '!') + "lost"), ConditionError);
  EXPECT_THROW((void)Condition(std::string(1500, '-') + "1"), ConditionError);
  EXPECT_THROW((void)Condition(std::string(5000, '1')), ConditionError);
}

TEST(FrameFigures, NamesAreUniqueAndExplained) {
  std::set<std::string_view> names;
  ASSERT_FALSE(frame_figure_infos().empty());
  for (const FigureInfo& info : frame_figure_infos()) {
    EXPECT_TRUE(names.insert(info.name).second) << info.name;
    EXPECT_FALSE(info.help.empty()) << info.name;
    EXPECT_NO_THROW((void)Condition(info.name)) << info.name;
    EXPECT_THAT(condition_help(), HasSubstr(std::string(info.name)));
  }
}

TEST(FramesText, JoinsNeighbours) {
  EXPECT_EQ(frames_text({}), "");
  EXPECT_EQ(frames_text({4}), "4");
  EXPECT_EQ(frames_text({1, 2, 3, 7, 9, 10}), "1-3, 7, 9-10");
}

TEST(Condition, TellsHowNearItsFiguresCome) {
  const std::vector<FrameRecord> ten = ten_records();
  const FrameFigures figures({ten});
  const std::vector<int> all = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, some = {5, 6, 8};
  EXPECT_EQ(Condition("inliers > 100").reach(figures, all), "inliers from 0 (frame 0) to 90 (frame 9)");
  EXPECT_EQ(Condition("inliers > 100").reach(figures, some), "inliers from 50 (frame 5) to 80 (frame 8)");
  EXPECT_EQ(Condition("mask > 50 %").reach(figures, some), "mask from 5.00 % (frame 5) to 8.00 % (frame 8)");
  EXPECT_EQ(Condition("matches > 100").reach(figures, all), "matches is 100 throughout");
  EXPECT_EQ(Condition("lost").reach(figures, some), "lost at none");
  EXPECT_EQ(Condition("lost && inliers > 100").reach(figures, {3, 4, 5}),
            "lost at some; inliers from 30 (frame 3) to 50 (frame 5)");
  EXPECT_EQ(Condition("rpe > 2 cm").reach(figures, all), "none has rpe");
}

}  // namespace
}  // namespace stillpoint
