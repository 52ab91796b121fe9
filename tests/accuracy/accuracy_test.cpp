// How good the methods are, end to end, on sequences whose truth is known.
#include <gtest/gtest.h>

#include <set>
#include <sstream>

#include "tests/accuracy/runs.hpp"

namespace stillpoint {
namespace {

/// RMSE of the relative pose error over 1 s in m, and the mask of `stillpoint` against the truth.
struct Measured {
  SequenceChoice sequence;
  double none_m, paper_m, oracle_m, stillpoint_m;
  double iou;  ///< 0 to 1; 0 where nothing moves
};

// What was measured over 60 frames, 31 pairs of poses, with OpenCV's baseline code (see main.cpp). With AVX2
// no error differs by 1e-5 m and no IoU by 0.001. The program prints what it measures, a line a run, so that
// the table can be set anew.
//
// The seeds of `approach` are two on which `none` goes with the walker and `stillpoint` did before it sought
// the pose that most of the image agrees on: without that its errors are 0.42 and 0.13 m, and without looking
// for receding patches the mask of seed 21 holds nothing (IoU 0.002). They are not its worst: on seeds 1, 2,
// 5, 6, 7 and 42 it has 1.08, 1.12, 1.31, 2.00 (0.0073 m), 1.38 and 1.31 times the error of `oracle`.
// clang-format off
const Measured kMeasured[] = {
    //                       none     paper    oracle   stillpoint  IoU
    {{"walking_xyz", 1},     0.04576, 0.02868, 0.00537, 0.00320,    0.926},
    {{"walking_xyz", 2},     0.42294, 0.41021, 0.00703, 0.00530,    0.952},
    {{"walking_static", 1},  0.01644, 0.01086, 0.00281, 0.00341,    0.943},
    {{"walking_static", 2},  0.01822, 0.01102, 0.00333, 0.00298,    0.936},
    {{"approach", 21},       0.08555, 0.08555, 0.00382, 0.00445,    0.747},
    {{"approach", 22},       0.13596, 0.13596, 0.00333, 0.00360,    0.887},
    {{"sitting_static", 1},  0.00754, 0.00797, 0.00298, 0.00289,    0.357},
    {{"sitting_static", 2},  0.01259, 0.01259, 0.00265, 0.00257,    0.370},
    {{"room", 1},            0.00287, 0.00287, 0.00277, 0.00274,    0},
    {{"room", 2},            0.00288, 0.00288, 0.00228, 0.00229,    0},
};
// clang-format on

// How far from that a run may be: what is good may not worsen by more, what is bad may not change by more
// either way.
constexpr double kOfOracle = 1.3;    // error of `stillpoint`, times that of `oracle`
constexpr double kWorse = 1.3;       // error of `stillpoint` and `oracle`, times what was measured
constexpr double kBandLow = 0.75;    // error of `none` and `paper`, times what was measured
constexpr double kBandHigh = 1.33;   // …
constexpr double kIouMargin = 0.05;  // below what was measured
constexpr double kRoomMask = 0.002;  // share of the pixels masked where nothing moves
// Errors of a pose that goes with the dynamic object, times those of one that does not.
constexpr double kCapturedBy = 10.0;
constexpr double kCapturedByOfOracle = 8.0;  // which is the worse of both on walking_xyz

class Accuracy : public testing::TestWithParam<Measured> {
 protected:
  static const RunFigures& run(const char* method) { return figures_of(GetParam().sequence, method); }
  static bool moves() { return GetParam().sequence.kind != "room"; }
};

TEST_P(Accuracy, EveryFrameHasAPose) {
  for (const char* method : {"none", "paper", "oracle", "stillpoint"}) {
    EXPECT_EQ(run(method).coverage, 1.0) << method;
    EXPECT_EQ(run(method).pairs, kFrames - 29) << method;
  }
}

TEST_P(Accuracy, StillpointIsAboutAsGoodAsTheOracle) {
  EXPECT_LE(run("stillpoint").rpe_m, kOfOracle * run("oracle").rpe_m);
}

TEST_P(Accuracy, StillpointAndTheOracleAreNoWorseThanTheyWere) {
  EXPECT_LE(run("stillpoint").rpe_m, kWorse * GetParam().stillpoint_m);
  EXPECT_LE(run("oracle").rpe_m, kWorse * GetParam().oracle_m);
}

TEST_P(Accuracy, TheBaselinesAreWhatTheyWere) {
  for (const auto& [method, measured_m] :
       {std::pair{"none", GetParam().none_m}, {"paper", GetParam().paper_m}}) {
    EXPECT_GE(run(method).rpe_m, kBandLow * measured_m) << method;
    EXPECT_LE(run(method).rpe_m, kBandHigh * measured_m) << method;
  }
}

TEST_P(Accuracy, MasksHoldWhatMovesAndLittleElse) {
  if (moves()) {
    EXPECT_GE(run("stillpoint").iou, GetParam().iou - kIouMargin);
    EXPECT_EQ(run("oracle").iou, 1.0);
  } else {
    for (const char* method : {"paper", "stillpoint"}) EXPECT_LE(run(method).masked, kRoomMask) << method;
    EXPECT_EQ(run("oracle").masked, 0.0);
  }
  EXPECT_EQ(run("none").masked, 0.0);
}

TEST_P(Accuracy, AMoverTakesAlongWhoRemovesNothing) {
  const std::string& kind = GetParam().sequence.kind;
  if (kind == "approach" || kind == "walking_xyz") {
    EXPECT_GE(run("none").rpe_m, kCapturedByOfOracle * run("oracle").rpe_m);
    EXPECT_GE(run("none").rpe_m, kCapturedBy * run("stillpoint").rpe_m);
  } else if (moves()) {
    EXPECT_GE(run("none").rpe_m, 2.0 * run("oracle").rpe_m);
  } else {
    EXPECT_NEAR(run("none").rpe_m, run("oracle").rpe_m, 0.001);
  }
}

INSTANTIATE_TEST_SUITE_P(RenderedSequences, Accuracy, testing::ValuesIn(kMeasured),
                         [](const auto& tested) { return name_of(tested.param.sequence); });

/// Each sequence is a test of its own to ctest, which would not miss one that nobody told it of.
TEST(RenderedSequences, AreThoseThatCtestKnows) {
  std::set<std::string> measured, known;
  for (const Measured& one : kMeasured) measured.insert(name_of(one.sequence));
  std::istringstream list(STILLPOINT_ACCURACY_FILMS);
  for (std::string name; list >> name;) known.insert(name);
  EXPECT_EQ(measured, known);
}

}  // namespace
}  // namespace stillpoint
