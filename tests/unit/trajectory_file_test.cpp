#include "core/geometry/trajectory_file.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/temporary_folder.hpp"

namespace stillpoint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// The pose all files below hold: at (0.25, -1.5, 2), turned by 2 acos(0.8) about x.
void expect_the_pose(const TrajectoryFile& file, double stamp) {
  ASSERT_GE(file.poses.size(), 1U);
  const Pose& pose = file.poses[0].world_from_camera;
  EXPECT_DOUBLE_EQ(file.poses[0].timestamp, stamp);
  EXPECT_LT((pose.translation() - Eigen::Vector3d(0.25, -1.5, 2)).norm(), 1e-12);
  const Eigen::Quaterniond expected(0.8, 0.6, 0, 0);
  EXPECT_LT((pose.linear() - expected.toRotationMatrix()).norm(), 1e-12);
}

class TrajectoryFiles : public testing::Test {
 protected:
  TrajectoryFile read(const std::string& text, std::optional<QuaternionOrder> order = {}) const {
    folder_.write("t.txt", text);
    return read_trajectory_file(folder_.path("t.txt"), order);
  }
  TemporaryFolder folder_;
};

TEST_F(TrajectoryFiles, AreReadWithAnySeparator) {
  expect_the_pose(read("1.5 0.25 -1.5 2 0.6 0 0 0.8\n"), 1.5);
  expect_the_pose(read("1.5,0.25,-1.5,2,0.6,0,0,0.8\n"), 1.5);
  expect_the_pose(read("1.5, 0.25, -1.5, 2, 0.6, 0, 0, 0.8\r\n"), 1.5);
  expect_the_pose(read("1.5;0.25;-1.5;2;0.6;0;0;0.8\n"), 1.5);
  expect_the_pose(read("\"1.5\",\"0.25\",\"-1.5\",\"2\",\"0.6\",\"0\",\"0\",\"0.8\"\n"), 1.5);
  expect_the_pose(read("1.5\t+0.25\t-1.5e0\t2\t0.6\t0\t0\t0.8"), 1.5);
}

TEST_F(TrajectoryFiles, AreReadWithDecimalCommas) {
  expect_the_pose(read("1,5 0,25 -1,5 2 0,6 0 0 0,8\n2,5 0,25 -1,5 2,0 0,6 0,0 0,0 0,8\n"), 1.5);
  expect_the_pose(read("1,5;0,25;-1,5;2,0;0,6;0,0;0,0;0,8\n"), 1.5);
}

TEST_F(TrajectoryFiles, OrderComesFromTheHeader) {
  const TrajectoryFile tum_vi = read(
      "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
      "1520530308199447626,0.25,-1.5,2,0.8,0.6,0,0\n");
  expect_the_pose(tum_vi, 1520530308199447626.0);
  EXPECT_EQ(tum_vi.order, QuaternionOrder::wxyz);
  EXPECT_TRUE(tum_vi.order_is_named);
  expect_the_pose(read("timestamp,x,y,z,qw,qx,qy,qz\n1.5,0.25,-1.5,2,0.8,0.6,0,0\n"), 1.5);
  expect_the_pose(read("# time qx qy qz qw tx ty tz\n1.5 0.6 0 0 0.8 0.25 -1.5 2\n"), 1.5);
  const TrajectoryFile tum = read("# timestamp tx ty tz qx qy qz qw\n1.5 0.25 -1.5 2 0.6 0 0 0.8\n");
  expect_the_pose(tum, 1.5);
  EXPECT_TRUE(tum.order_is_named);
  EXPECT_FALSE(read("1.5 0.25 -1.5 2 0.6 0 0 0.8\n").order_is_named);
  expect_the_pose(read("1.5 0.25 -1.5 2 0.8 0.6 0 0\n", QuaternionOrder::wxyz), 1.5);
}

TEST_F(TrajectoryFiles, EurocsSeventeenColumnsHaveWFirst) {
  const std::string row = "1403636579763555584,0.25,-1.5,2,0.8,0.6,0,0,0.1,0.2,0.3,0,0,0,0,0,0\r\n";
  expect_the_pose(read(row), 1403636579763555584.0);
  expect_the_pose(
      read(
          "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], "
          "v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1], b_w_RS_S_x [rad s^-1], b_w_RS_S_y [rad "
          "s^-1], b_w_RS_S_z [rad s^-1], b_a_RS_S_x [m s^-2], b_a_RS_S_y [m s^-2], b_a_RS_S_z [m s^-2]\n" +
          row),
      1403636579763555584.0);
}

TEST_F(TrajectoryFiles, KittisMatricesHaveNoStamps) {
  const TrajectoryFile file = read("1 0 0 0.25 0 0.28 -0.96 -1.5 0 0.96 0.28 2\n1 0 0 9 0 1 0 9 0 0 1 9\n");
  expect_the_pose(file, 0.0);
  EXPECT_FALSE(file.has_stamps);
  EXPECT_EQ(file.poses[1].timestamp, 1.0);
  EXPECT_THAT(input_error_of([&] { (void)read("1 2 3 4 5 6 7 8 9 10 11 12\n"); }),
              HasSubstr("no rotation and translation"));
}

TEST_F(TrajectoryFiles, TartanAirsSevenNumbersHaveNoStamps) {
  const TrajectoryFile file = read("0.25 -1.5 2 0.6 0 0 0.8\nnan 0 0 0 0 0 1\n0.25 -1.5 2 0.6 0 0 0.8\n");
  expect_the_pose(file, 0.0);
  EXPECT_FALSE(file.has_stamps);
  ASSERT_EQ(file.poses.size(), 2U);
  EXPECT_EQ(file.poses[1].timestamp, 2.0) << "a row without a pose keeps its place";
  EXPECT_THAT(file.warnings, ElementsAre(HasSubstr("NaN or infinity")));
  const std::string w_first = "0.25 -1.5 2 0.8 0.6 0 0\n";
  expect_the_pose(read(w_first + w_first, QuaternionOrder::wxyz), 0.0);
  // A stamp, a place and three angles.
  EXPECT_THAT(input_error_of([&] { (void)read("1.5 0.25 -1.5 2 0.1 0.2 0.3\n"); }),
              HasSubstr("found 7 columns, expected the 8 numbers timestamp tx ty tz"));
}

TEST_F(TrajectoryFiles, MatricesMayStandBehindAStamp) {
  const std::string rows = "1 0 0 0.25 0 0.28 -0.96 -1.5 0 0.96 0.28 2";
  const TrajectoryFile kitti = read("1.5 " + rows + "\n2.5 " + rows + "\n");
  expect_the_pose(kitti, 1.5);
  EXPECT_TRUE(kitti.has_stamps);
  EXPECT_EQ(kitti.poses.size(), 2U);
  // As many columns as EuRoC's, whose last nine are velocity and biases.
  const TrajectoryFile whole = read("1.5 " + rows + " 0 0 0 1\n2.5 " + rows + " 0 0 0 1\n");
  expect_the_pose(whole, 1.5);
  EXPECT_TRUE(whole.has_stamps);
  expect_the_pose(read("1.5, 0.25, -1.5, 2, 0.8, 0.6, 0, 0, 1, 2, 3, 0, 0, 0, 0, 0, 0\n"), 1.5);
  // A first row that is cut off tells nothing.
  const TrajectoryFile cut = read("0.5 1 0\n1.5 " + rows + " 0 0 0 1\n2.5 " + rows + " 0 0 0 1\n");
  expect_the_pose(cut, 1.5);
  EXPECT_THAT(cut.warnings, ElementsAre(HasSubstr("expected a stamp and the 16 numbers of a 4x4 matrix")));
  // Thirteen numbers that are no matrix are none.
  EXPECT_THROW(read("1 2 3 4 5 6 7 8 9 10 11 12 13\n"), InputError);
}

TEST_F(TrajectoryFiles, AMessagesStampGoesBeforeTheTimeOfRecording) {
  expect_the_pose(
      read("%time,field.header.seq,field.header.stamp,field.pose.position.x,field.pose.position.y,"
           "field.pose.position.z,field.pose.orientation.x,field.pose.orientation.y,"
           "field.pose.orientation.z,field.pose.orientation.w\n"
           "1505000000,7,1500000000,0.25,-1.5,2,0.6,0,0,0.8\n"),
      1500000000);
  expect_the_pose(read("Time,header.seq,header.stamp.secs,header.stamp.nsecs,header.frame_id,pose.position.x,"
                       "pose.position.y,pose.position.z,pose.orientation.x,pose.orientation.y,"
                       "pose.orientation.z,pose.orientation.w\n"
                       "1.505,7,1,500000000,world,0.25,-1.5,2,0.6,0,0,0.8\n"),
                  1.5);
  expect_the_pose(read("time,x,y,z,qx,qy,qz,qw\n1.5,0.25,-1.5,2,0.6,0,0,0.8\n"), 1.5);
}

TEST_F(TrajectoryFiles, ABadMatrixKeepsItsRowsPlace) {
  const std::string good = "1 0 0 0.25 0 0.28 -0.96 -1.5 0 0.96 0.28 2\n",
                    none = "nan nan nan nan 0 0 0 0 0 0 0 0\n";
  const TrajectoryFile file = read(good + none + good + "1 0 0 9\n" + good);
  ASSERT_EQ(file.poses.size(), 3U);
  EXPECT_EQ(file.skipped, 2);
  EXPECT_EQ(file.poses[1].timestamp, 2.0);
  EXPECT_EQ(file.poses[2].timestamp, 4.0);
}

TEST_F(TrajectoryFiles, OneBadRowCostsThatRow) {
  std::string text;
  for (int i = 0; i < 9; ++i) text += fmt::format("{} 0.25 -1.5 2 0.6 0 0 0.8\n", 1.5 + i);
  const TrajectoryFile file = read(text +
                                   "20 NaN NaN NaN NaN NaN NaN NaN\n21 NaN NaN NaN NaN NaN NaN NaN\n"
                                   "22 1 2 3 0.6 0 0\n23 1 2 3 0 0 0 0\n24 0.25 -1.");
  expect_the_pose(file, 1.5);
  EXPECT_EQ(file.poses.size(), 9U);
  EXPECT_EQ(file.rows, 14);
  EXPECT_EQ(file.skipped, 5);
  EXPECT_THAT(
      file.warnings,
      ElementsAre(HasSubstr("t.txt:10: a row of NaN or infinity holds no pose and was skipped (2 in all)"),
                  HasSubstr("t.txt:12: a row holds no pose"),
                  HasSubstr("t.txt:13: a row's rotation is none")));
}

TEST_F(TrajectoryFiles, RowsBeyondAllMeasureAreSkippedWithACount) {
  const std::string rows = "1.5 0.25 -1.5 2 0.6 0 0 0.8\n2.5 1 2 3 0 0 0 1\n";
  const TrajectoryFile file = read(rows + "3.5 1e200 0 0 0 0 0 1\n1e300 1 2 3 0 0 0 1\n");
  expect_the_pose(file, 1.5);
  EXPECT_EQ(file.poses.size(), 2U);
  EXPECT_EQ(file.skipped, 2);
  EXPECT_THAT(file.warnings,
              ElementsAre(HasSubstr("t.txt:3: a row's stamp or position is beyond all measure and it was "
                                    "skipped (2 in all)")));
  EXPECT_THAT(input_error_of([this] { (void)read("1.5 1e200 0 0 0 0 0 1\n2.5 0 -1e99 0 0 0 0 1\n"); }),
              HasSubstr("found a stamp or a position beyond all measure (2 of 2 rows hold no pose)"));
  const TrajectoryFile matrix = read("1 0 0 1 0 1 0 2 0 0 1 3\n1 0 0 1 0 1 0 -1e12 0 0 1 3\n");
  EXPECT_EQ(matrix.poses.size(), 1U);
}

}  // namespace
}  // namespace stillpoint
