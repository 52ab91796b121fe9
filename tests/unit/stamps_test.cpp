#include "core/sequence/stamps.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/evaluation/clocks.hpp"

namespace stillpoint {
namespace {

/// 40 stamps from `start` s on at `rate` Hz, written in units of which `per_second` make a second; whole if
/// asked for.
std::vector<double> written(double start, double rate, double per_second, bool whole = false) {
  std::vector<double> stamps;
  for (int i = 0; i < 40; ++i) {
    const double stamp = (start + i / rate) * per_second;
    stamps.push_back(whole ? std::round(stamp) : stamp);
  }
  return stamps;
}

TEST(StampUnit, IsToldBySizeSince1970) {
  EXPECT_EQ(unit_of(written(1305031102.175, 30, 1)), StampUnit::seconds);
  EXPECT_EQ(unit_of(written(1305031102.175, 30, 1e3)), StampUnit::milliseconds);
  EXPECT_EQ(unit_of(written(1305031102.175, 30, 1e3, true)), StampUnit::milliseconds);
  EXPECT_EQ(unit_of(written(1305031102.175, 30, 1e6, true)), StampUnit::microseconds);
  EXPECT_EQ(unit_of(written(1305031102.175, 30, 1e9, true)), StampUnit::nanoseconds);
  EXPECT_EQ(unit_of({1305031102}), StampUnit::seconds);
  EXPECT_EQ(unit_of({1305031102000000000}), StampUnit::nanoseconds);
  // Whole seconds of today are no frame numbers.
  EXPECT_EQ(unit_of(written(1305031102, 1, 1, true)), StampUnit::seconds);
}

TEST(StampUnit, IsToldByTheStepOfClocksThatBeganElsewhere) {
  for (const double start : {0.0, 12.5, 3600.0}) {
    EXPECT_EQ(unit_of(written(start, 30, 1)), StampUnit::seconds) << start;
    EXPECT_EQ(unit_of(written(start, 30, 1e3, true)), StampUnit::milliseconds) << start;
    EXPECT_EQ(unit_of(written(start, 10, 1e3, true)), StampUnit::milliseconds) << start;
    EXPECT_EQ(unit_of(written(start, 30, 1e6, true)), StampUnit::microseconds) << start;
    EXPECT_EQ(unit_of(written(start, 200, 1e9, true)), StampUnit::nanoseconds) << start;
  }
  EXPECT_EQ(unit_of({7}), StampUnit::seconds);
  EXPECT_EQ(unit_of({}), StampUnit::seconds);
}

TEST(StampUnit, FrameNumbersGoUpByOnesOrByOneSmallStep) {
  EXPECT_EQ(unit_of({0, 1, 2, 5}), StampUnit::frames);
  EXPECT_EQ(unit_of({5, 0, 10, 15}), StampUnit::frames);
  EXPECT_EQ(unit_of({0, 10, 20}), StampUnit::frames);
  EXPECT_EQ(unit_of({0, 2, 5, 7, 10}), StampUnit::frames);
  EXPECT_EQ(unit_of({0, 1, 2.5}), StampUnit::seconds);
}

TEST(StampUnit, BesideOthersIsTheOneThatMeetsThem) {
  const std::vector<double> numbered = {0, 1, 2, 3, 4}, seconds = {0, 1 / 30.0, 2 / 30.0, 3 / 30.0, 4 / 30.0};
  EXPECT_EQ(unit_beside(numbered, seconds, StampUnit::frames, 30, 0.02), StampUnit::frames);
  EXPECT_EQ(unit_beside(numbered, seconds, StampUnit::seconds, 30, 0.02), StampUnit::frames);
  EXPECT_EQ(unit_beside(seconds, seconds, StampUnit::frames, 30, 0.02), StampUnit::seconds);
  // Keyframes by number, steps uneven: milliseconds by themselves, frames beside frames.
  EXPECT_EQ(unit_beside({0, 17, 38}, written(0, 30, 1), StampUnit::frames, 30, 0.02), StampUnit::frames);
  // Truth of another clock is not squeezed until it fits.
  const auto epoch = written(1305031102.175, 100, 1);
  EXPECT_EQ(unit_beside(epoch, written(0, 30, 1), StampUnit::frames, 30, 0.02), StampUnit::seconds);
}

Trajectory at(const std::vector<double>& stamps) {
  Trajectory trajectory;
  for (const double stamp : stamps) trajectory.push_back({stamp, Pose::Identity()});
  return trajectory;
}

/// The stamps of the middle pose of both once their clocks are settled.
std::pair<double, double> settled(std::vector<double> truth, std::vector<double> estimate,
                                  const ClockOptions& options = {}) {
  Trajectory t = at(truth), e = at(estimate);
  (void)settle_clocks(t, e, options);
  return {t[20].timestamp, e[20].timestamp};
}

TEST(Clocks, AreSettledAlikeForTruthAndEstimate) {
  std::vector<double> numbers;
  for (int i = 0; i < 40; ++i) numbers.push_back(i);
  const double at_20 = 20 / 30.0;
  using Both = std::pair<double, double>;
  EXPECT_EQ(settled(numbers, numbers), Both(20 * (1 / 30.0), 20 * (1 / 30.0)));
  const auto mixed = settled(numbers, written(0, 30, 1));
  EXPECT_NEAR(mixed.first, at_20, 1e-12);
  EXPECT_NEAR(mixed.second, at_20, 1e-12);
  EXPECT_NEAR(settled(written(0, 30, 1), numbers).second, at_20, 1e-12);
  const auto nano = settled(written(1.7e9, 30, 1), written(1.7e9, 30, 1e9, true));
  EXPECT_NEAR(nano.second, nano.first, 1e-6);
  // One pose a second is one pose a second, where the other trajectory says so.
  std::vector<double> long_one;
  for (int i = 0; i < 39 * 30; ++i) long_one.push_back(i / 30.0);
  EXPECT_EQ(settled(numbers, long_one).first, 20.0);
  // An estimate that counts the frames of a sequence with stamps of its own.
  ClockOptions options;
  options.truth_in_seconds = true;
  options.frame_stamps = written(1.7e9, 30, 1);
  EXPECT_EQ(settled(options.frame_stamps, numbers, options).second, options.frame_stamps[20]);
}

TEST(Clocks, FramesMayBeNumberedFromOne) {
  ClockOptions options;
  options.truth_in_seconds = true;
  options.frame_stamps = written(1.7e9, 30, 1);
  const auto count = static_cast<int>(options.frame_stamps.size());
  const auto numbered = [&](int first, int last) {
    std::vector<double> numbers;
    for (int i = first; i <= last; ++i) numbers.push_back(i);
    Trajectory truth = at(options.frame_stamps), estimate = at(numbers);
    const auto notes = settle_clocks(truth, estimate, options);
    return std::pair(estimate.front().timestamp, notes.empty() ? std::string() : notes.front());
  };
  const auto [from_one, note] = numbered(1, count);
  EXPECT_EQ(from_one, options.frame_stamps[0]);
  EXPECT_NE(note.find("frame numbers from 1;"), std::string::npos) << note;
  // Frame 0 may have been lost: what can be read from 0 is.
  EXPECT_EQ(numbered(1, count - 1).first, options.frame_stamps[1]);
  EXPECT_EQ(numbered(1, count - 1).second.find("from 1"), std::string::npos);
  // Beside frames that are numbers themselves, too: a frame off they would meet as well, all but one.
  options.frame_stamps.clear();
  for (int i = 0; i < count; ++i) options.frame_stamps.push_back(i / 30.0);
  EXPECT_EQ(numbered(1, count).first, 0.0);
}

/// A camera that goes and turns at an uneven pace.
Pose uneven(double t) {
  Pose pose;
  pose.linear() = so3_exp({0.3 * std::sin(t), 0.5 * t, 0.2 * std::sin(1.7 * t)});
  pose.translation() = Eigen::Vector3d(std::sin(1.3 * t), t * t, 0.3 * t);
  return pose;
}

/// `count` frames at 30 Hz and the truth at them, beside rows of every `every`-th.
struct Rows {
  Rows(int count, int every, double scale = 1.0) {
    for (int i = 0; i < count; ++i) {
      stamps.push_back(1.7e9 + i / 30.0);
      truth.push_back({stamps.back(), uneven(i / 30.0)});
      if (i % every != 0) continue;
      file.poses.push_back({static_cast<double>(file.rows++), truth.back().world_from_camera});
      file.poses.back().world_from_camera.translation() *= scale;
    }
    file.has_stamps = false;
  }
  std::string laid(bool with_truth = true) {
    return lay_rows_on_frames(file, stamps, with_truth ? truth : Trajectory(), "it");
  }
  [[nodiscard]] bool has(const std::string& said, const char* part) const {
    return said.find(part) != std::string::npos;
  }
  std::vector<double> stamps;
  Trajectory truth;
  TrajectoryFile file;
};

TEST(Clocks, RowsWithoutStampsAreLaidOnTheFramesThatTheyFit) {
  Rows all(80, 1);
  EXPECT_EQ(all.laid(), "it: the rows have no stamps; each was given its frame's time");
  EXPECT_EQ(all.file.poses[7].timestamp, all.stamps[7]);
  for (const double scale : {1.0, 20.0})
    for (const int every : {2, 3}) {
      Rows some(81, every, scale);
      const std::string said = some.laid();
      EXPECT_TRUE(some.has(said, every == 2 ? "41 rows without stamps do not say which of the 81 frames"
                                            : "they were given the times of every 3rd"))
          << said;
      EXPECT_EQ(some.file.poses[7].timestamp, some.stamps[7 * static_cast<std::size_t>(every)]) << said;
    }
  // Half of a run is half of a run.
  Rows half(80, 1);
  half.file.poses.resize(40);
  half.file.rows = 40;
  const std::string said = half.laid();
  EXPECT_TRUE(half.has(said, "the times of the first 40, for motions")) << said;
  EXPECT_EQ(half.file.poses[7].timestamp, half.stamps[7]);
}

TEST(Clocks, RowsWithoutStampsThatNothingSettlesAreToldToBeOpen) {
  Rows alone(80, 2);
  const std::string open = alone.laid(false);
  EXPECT_TRUE(alone.has(open, "the times of the first 40, and may as well be every 2nd")) << open;
  EXPECT_EQ(alone.file.poses[7].timestamp, alone.stamps[7]);
  Rows odd(80, 1);
  odd.file.poses.resize(57);
  odd.file.rows = 57;
  EXPECT_TRUE(odd.has(odd.laid(), "57 rows without stamps do not say which of the 80 frames they are"));
  Rows more(80, 1);
  more.stamps.resize(50);
  const std::string rest = more.laid();
  EXPECT_TRUE(more.has(rest, "the first 50 were given the frames' times and the rest left out")) << rest;
  EXPECT_EQ(more.file.poses.size(), 50U);
  Rows stamped(80, 2);
  stamped.file.has_stamps = true;
  EXPECT_EQ(stamped.laid(), "");
  EXPECT_EQ(stamped.file.poses[7].timestamp, 7.0);
}

TEST(Clocks, OfAnotherOriginAreToldWithTheWayOn) {
  Trajectory truth = at(written(1.7e9, 30, 1)), estimate = at(written(0, 30, 1));
  ClockOptions options;
  (void)settle_clocks(truth, estimate, options);
  EXPECT_NE(why_apart(truth, estimate, options).find("--time-offset 1700000000.000000"), std::string::npos);
  options.estimate_offset_s = 1.7e9;
  truth = at(written(1.7e9, 30, 1)), estimate = at(written(0, 30, 1));
  (void)settle_clocks(truth, estimate, options);
  EXPECT_NEAR(estimate[20].timestamp, truth[20].timestamp, 1e-6);
}

}  // namespace
}  // namespace stillpoint
