#include "core/geometry/trajectory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <numbers>

#include "core/text_file.hpp"
#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using testing::HasSubstr;

StampedPose at(double timestamp, double x, double angle_z = 0.0) {
  StampedPose pose;
  pose.timestamp = timestamp;
  pose.world_from_camera.translation().x() = x;
  pose.world_from_camera.linear() = so3_exp({0, 0, angle_z});
  return pose;
}

TEST(TumTrajectory, ReadsCommentsCrlfAndCommas) {
  const TemporaryFolder folder;
  folder.write(
      "t.txt",
      "# header\r\n\r\n1.5 1 2 3 0 0 0.70710678 0.70710678 # a quarter turn\r\n2.5,4,5,6,0,0,0,1\r\n");
  std::vector<std::string> warnings;
  const Trajectory read = read_tum_trajectory(folder.path("t.txt"), &warnings);
  ASSERT_EQ(read.size(), 2U);
  EXPECT_TRUE(warnings.empty());
  EXPECT_EQ(read[0].timestamp, 1.5);
  EXPECT_LT((read[0].world_from_camera * Eigen::Vector3d::UnitX() - Eigen::Vector3d(1, 3, 3)).norm(), 1e-7);
  EXPECT_EQ(read[1].world_from_camera.translation(), Eigen::Vector3d(4, 5, 6));
}

TEST(TumTrajectory, WritesEightColumnsThatReadBackTheSame) {
  const TemporaryFolder folder;
  const Trajectory written = {at(1305031102.175304, 1.25, 0.5), at(1305031102.211214, -3.75, -2.9)};
  write_tum_trajectory(folder.path("t.txt"), written);
  for (const TextLine& line : read_text_lines(folder.path("t.txt")))
    EXPECT_EQ(split_columns(line.text).size(), 8U);
  const Trajectory read = read_tum_trajectory(folder.path("t.txt"));
  ASSERT_EQ(read.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_DOUBLE_EQ(read[i].timestamp, written[i].timestamp);
    EXPECT_LT((read[i].world_from_camera.matrix() - written[i].world_from_camera.matrix()).norm(), 1e-8);
  }
  EXPECT_THAT(input_error_of([&] { write_tum_trajectory(folder.path("no/such/folder.txt"), written); }),
              HasSubstr("folder.txt: cannot be written"));
}

TEST(TumTrajectory, SortsAndDropsRepeatsWithAWarning) {
  const TemporaryFolder folder;
  folder.write("t.txt", "2 20 0 0 0 0 0 1\n1 10 0 0 0 0 0 1\n2 21 0 0 0 0 0 1\n3 30 0 0 0 0 0 1.005\n");
  std::vector<std::string> warnings;
  const Trajectory read = read_tum_trajectory(folder.path("t.txt"), &warnings);
  ASSERT_EQ(read.size(), 3U);
  EXPECT_EQ(read[0].world_from_camera.translation().x(), 10);
  EXPECT_EQ(read[1].world_from_camera.translation().x(), 20);
  EXPECT_NEAR(read[2].world_from_camera.linear().determinant(), 1.0, 1e-12);
  EXPECT_THAT(warnings,
              testing::ElementsAre(HasSubstr("t.txt:2: a pose is earlier"),
                                   HasSubstr("t.txt:3: a pose repeats"), HasSubstr("t.txt:4: a quaternion")));
}

struct BadTrajectory {
  const char *text, *complaint;
};
/// What the test is called by.
void PrintTo(const BadTrajectory& bad, std::ostream* to) { *to << bad.complaint; }

class BadTrajectories : public testing::TestWithParam<BadTrajectory> {};

TEST_P(BadTrajectories, AreToldWithFileAndLine) {
  const TemporaryFolder folder;
  folder.write("t.txt", GetParam().text);
  EXPECT_THAT(input_error_of([&] { (void)read_tum_trajectory(folder.path("t.txt")); }),
              HasSubstr(GetParam().complaint));
}

INSTANTIATE_TEST_SUITE_P(
    TumTrajectory, BadTrajectories,
    testing::Values(BadTrajectory{"", "t.txt: holds no poses"},
                    BadTrajectory{"# only\n\n", "t.txt: holds no poses"},
                    BadTrajectory{"2 0 0 0 nan 0 0 1\n", "t.txt:1: found 'nan' in column 5"},
                    BadTrajectory{"1 inf 0 0 0 0 0 1\n", "t.txt:1: found 'inf' in column 2"},
                    BadTrajectory{"#\n1 0 0 0 0 0 0 0\n", "t.txt:2: found a quaternion of length 0,"},
                    BadTrajectory{"1 0 0 0 0 0 1 1\n", "t.txt:1: found a quaternion of length 1.414"},
                    BadTrajectory{"1 0 0 0 0 0 1\n", "t.txt:1: found 7 columns"},
                    BadTrajectory{"1 0 0 0 0 0 0 1 9\n", "t.txt:1: found 9 columns"},
                    BadTrajectory{"1 0 0 x 0 0 0 1\n", "t.txt:1: found 'x' in column 4"},
                    BadTrajectory{"1 0 0 0 0 0 0 1\n2 0 0\n", "t.txt:2: found 3 columns"},
                    BadTrajectory{"1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n",
                                  "t.txt:2: 3 of 4 poses repeat an earlier stamp"}));

TEST(TumTrajectory, MissingFilesAndFoldersAreTold) {
  const TemporaryFolder folder;
  EXPECT_THAT(input_error_of([&] { (void)read_tum_trajectory(folder.path("none.txt")); }),
              HasSubstr("none.txt: cannot be read: No such file"));
  EXPECT_THAT(input_error_of([&] { (void)read_tum_trajectory(folder.path()); }),
              HasSubstr("a folder, where"));
}

TEST(Numbers, AreReadTheSameInEveryLocale) {
  const char* chosen = std::setlocale(LC_NUMERIC, "de_DE.UTF-8");
  EXPECT_EQ(parse_number("1305031102.175304"), 1305031102.175304);
  EXPECT_EQ(parse_number("+0.5"), 0.5);
  EXPECT_EQ(parse_number("-1e-3"), -1e-3);
  EXPECT_FALSE(parse_number("1,5"));
  EXPECT_FALSE(parse_number("1.5m"));
  EXPECT_FALSE(parse_number("+-1"));
  EXPECT_FALSE(parse_number(""));
  if (chosen != nullptr) std::setlocale(LC_NUMERIC, "C");
}

TEST(NearestPose, IsStrictlyCloserThanTheTolerance) {
  const Trajectory trajectory = {at(1.0, 0), at(1.5, 1), at(2.0, 2)};
  EXPECT_EQ(nearest_pose(trajectory, 1.5, 0.1), 1U);
  EXPECT_EQ(nearest_pose(trajectory, 1.7, 0.25), 1U);
  EXPECT_EQ(nearest_pose(trajectory, 1.8, 0.25), 2U);
  EXPECT_EQ(nearest_pose(trajectory, 0.75, 0.3), 0U);
  EXPECT_EQ(nearest_pose(trajectory, 2.2, 0.3), 2U);
  EXPECT_FALSE(nearest_pose(trajectory, 0.75, 0.25));
  EXPECT_FALSE(nearest_pose(trajectory, 2.25, 0.25));
  EXPECT_FALSE(nearest_pose({}, 1.0, 10.0));
}

TEST(Interpolate, IsLinearInTranslationAndSphericalInRotation) {
  const double quarter = std::numbers::pi / 2;
  const Trajectory trajectory = {at(1.0, 2.0, 0.0), at(2.0, 4.0, quarter), at(9.0, 0.0)};
  const auto pose = interpolate(trajectory, 1.25, 1.0);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation().x(), 2.5, 1e-12);
  EXPECT_LT((so3_log(pose->linear()) - Eigen::Vector3d(0, 0, quarter / 4)).norm(), 1e-12);
  EXPECT_TRUE(interpolate(trajectory, 1.0, 0.1));  // a stamp itself needs no neighbour
  EXPECT_FALSE(interpolate(trajectory, 0.99, 1.0));
  EXPECT_FALSE(interpolate(trajectory, 9.01, 1.0));
  EXPECT_FALSE(interpolate(trajectory, 5.0, 1.0));
}

}  // namespace
}  // namespace stillpoint
