#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/motion/paper/paper_config.hpp"
#include "core/odometry/engines.hpp"
#include "core/odometry/frame_record.hpp"
#include "core/run/frame_figures.hpp"
#include "core/run/removal_errors.hpp"
#include "ui/panels/parameter_rows.hpp"
#include "ui/panels/removal_summary.hpp"
#include "ui/panels/run_difference.hpp"
#include "ui/panels/run_look.hpp"

namespace stillpoint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

RemovalError error_of(int frame, double with_m, double without_m, int sign) {
  return {.frame = frame,
          .with_removal_m = with_m,
          .without_removal_m = without_m,
          .oracle_m = 0.002,
          .hurt = sign<0, .helped = sign> 0};
}

TEST(RemovalSummary, CountsAndFindsTheExtremes) {
  const std::vector<RemovalError> errors{error_of(4, 0.001, 0.011, 1),        error_of(5, 0.003, 0.004, 0),
                                         error_of(6, 0.009, 0.002, -1),       error_of(7, 0.005, 0.004, -1),
                                         error_of(8, std::nan(""), 0.004, 0), error_of(9, 0.002, 0.03, 1)};
  const RemovalSummary summary = summarise(errors);
  EXPECT_EQ(summary.compared, 5);
  EXPECT_EQ(summary.helped, 2);
  EXPECT_EQ(summary.hurt, 2);
  EXPECT_EQ(summary.worst_frame, 6);
  EXPECT_NEAR(summary.greatest_harm_m, 0.007, 1e-12);
  EXPECT_EQ(summary.best_frame, 9);
  EXPECT_NEAR(summary.greatest_gain_m, 0.028, 1e-12);
  EXPECT_NEAR(summary.median_with_m, 0.003, 1e-12);
  EXPECT_NEAR(summary.median_without_m, 0.004, 1e-12);
  EXPECT_EQ(summary.oracle, 5);
  EXPECT_EQ(summary.beat_oracle, 1);
  EXPECT_EQ(sentence_of(summary), "Removal helped in 2 of 5 frames, hurt in 2, and changed nothing in 1.");
  EXPECT_THAT(by_harm(errors), ElementsAre(6, 7));
}

TEST(RemovalSummary, SaysWhenThereIsNothingToCompare) {
  EXPECT_THAT(sentence_of(summarise({})), HasSubstr("No frame"));
  EXPECT_THAT(sentence_of(summarise({error_of(1, std::nan(""), 0.1, 0)})), HasSubstr("No frame"));
}

TEST(RunDifference, PosesAndFiguresAreCompared) {
  FrameRecord run, ghost;
  run.inliers = 200;
  ghost.inliers = 180;
  run.matches = ghost.matches = 230;
  run.world_from_camera.translation() = Eigen::Vector3d(1.0, 2.0, 3.0);
  ghost.world_from_camera.translation() = Eigen::Vector3d(1.0, 2.03, 3.04);
  ghost.world_from_camera.linear() = Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const FrameDifference difference = difference_of({std::vector{run}}, 0, {std::vector{ghost}}, 0);
  EXPECT_NEAR(difference.translation_m, 0.05, 1e-12);
  EXPECT_NEAR(difference.rotation_deg, 0.1 * 180.0 / 3.14159265358979, 1e-9);
  for (const FigurePair& pair : difference.figures)
    EXPECT_EQ(pair.differs, pair.name == "Inliers" || pair.name == "Outliers") << pair.name;
}

TEST(RunDifference, ADashStandsForWhatOnlyOneOfThemKnows) {
  FrameRecord run, ghost;
  run.inliers = 200, run.matches = 230, run.keyframe = true;
  ghost.measured = poses_alone();
  ghost.status = FrameStatus::tracked;
  const auto shown = [&](const FrameRecord& a, const FrameRecord& b, const std::string& name) {
    for (const FigurePair& pair : difference_of({std::vector{a}}, 0, {std::vector{b}}, 0).figures)
      if (pair.name == name) return pair.run + " " + pair.ghost;
    return std::string("is not told");
  };
  EXPECT_EQ(shown(run, ghost, "Inliers"), "200 –");
  EXPECT_EQ(shown(run, ghost, "Mask"), "0.00 % –");
  EXPECT_EQ(shown(run, ghost, "Keyframe"), "yes –");
  EXPECT_EQ(shown(run, ghost, "Map points"), "0 –");
  for (const FigurePair& pair : difference_of({std::vector{run}}, 0, {std::vector{ghost}}, 0).figures)
    EXPECT_EQ(pair.differs, pair.name == "Status") << pair.name;
  // What neither knows is no row.
  for (const char* name : {"Inliers", "Mask", "Keyframe", "Map points"})
    EXPECT_EQ(shown(ghost, ghost, name), "is not told") << name;
}

TEST(RunDifference, MasksOverlap) {
  cv::Mat run = cv::Mat::zeros(10, 10, CV_8UC1), ghost = run.clone();
  run(cv::Rect(0, 0, 4, 10)) = 255;
  ghost(cv::Rect(2, 0, 4, 10)) = 255;
  const MaskOverlap overlap = overlap_of(run, ghost);
  EXPECT_EQ(overlap.both, 20);
  EXPECT_EQ(overlap.only_run, 20);
  EXPECT_EQ(overlap.only_ghost, 20);
  EXPECT_NEAR(*overlap.iou(), 1.0 / 3.0, 1e-12);
  EXPECT_EQ(overlap_of(run, cv::Mat()).only_run, 40);
  EXPECT_FALSE(overlap_of(cv::Mat(), cv::Mat()).iou());
}

TEST(ParameterChanges, AreListedAndNamed) {
  Config from, to;
  EXPECT_TRUE(changes(to, from).empty());
  to.of<PaperConfig>().border_px = 7;
  EXPECT_EQ(change_name(to, from), "paper.border_px 7");
  to.run.method = "none";
  const auto all = changes(to, from);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].key, "run.method");
  EXPECT_EQ(all[0].before, from.run.method);
  EXPECT_EQ(all[1].value, "7");
  EXPECT_EQ(change_name(to, from), "run.method none, +1");
}

TEST(ParameterRows, AreFoundByKeyLabelAndHelp) {
  Config config;
  ASSERT_FALSE(parameters(config).empty());
  for (const Parameter& parameter : parameters(config)) {
    EXPECT_TRUE(matches(parameter, parameter.key));
    EXPECT_TRUE(matches(parameter, parameter.help));
    EXPECT_TRUE(matches(parameter, label_of(parameter)));
    EXPECT_FALSE(matches(parameter, "no such words"));
    const std::string section = section_of(parameter);
    const bool is_methods = section != "run" && section != "features" && section != "tracking" &&
                            section != "direct" && section != "map" && section != "bundle" &&
                            std::none_of(engines().begin(), engines().end(), [&](const EngineInfo& engine) {
                              return engine.parameters.name() == section;
                            });
    EXPECT_EQ(is_live(parameter), is_methods || parameter.key == "run.method") << parameter.key;
  }
}

TEST(RunLooks, DifferWithoutColourToo) {
  for (const ThemeName theme : {ThemeName::kDark, ThemeName::kLight})
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b) {
        EXPECT_NE(ghost_look(a, theme).colour, ghost_look(b, theme).colour);
        EXPECT_NE(ghost_look(a, theme).sign, ghost_look(b, theme).sign);
        EXPECT_NE(ghost_look(a, theme).dash, ghost_look(b, theme).dash);
      }
}

TEST(RunLooks, LongNamesAreCutBetweenLetters) {
  EXPECT_EQ(shortened("paper", 10), "paper");
  EXPECT_EQ(shortened("abcdefgh", 4), "abcd…");
  EXPECT_EQ(shortened("abcöde", 4), "abc…");
}

TEST(PoseText, AnotherWorldsPosesAreNotToldApart) {
  FrameDifference difference;
  EXPECT_EQ(pose_text(difference, "a", false), "Both poses are the same.");
  difference.translation_m = 1.5;
  difference.rotation_deg = 2.0;
  EXPECT_EQ(pose_text(difference, "a", false), "Poses differ by 1500.00 mm and 2.000 °.");
  const std::string outside = pose_text(difference, "orb3", true);
  EXPECT_EQ(outside.find("1500"), std::string::npos) << outside;
  EXPECT_NE(outside.find("orb3's poses are of a world of its own"), std::string::npos);
}

}  // namespace
}  // namespace stillpoint
