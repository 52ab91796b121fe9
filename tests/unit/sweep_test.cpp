#include "core/run/sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/odometry/frame_result.hpp"
#include "core/run/run_report.hpp"
#include "core/run/run_sequence.hpp"
#include "tests/support/rendered.hpp"

namespace stillpoint {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(SweepRanges, AreReadAsTheyAreTyped) {
  EXPECT_EQ(sweep_range("features.count=500:2000:4"), (SweepRange{"features.count", 500, 2000, 4}));
  EXPECT_EQ(sweep_range("stillpoint.a=-0.5:1e1"), (SweepRange{"stillpoint.a", -0.5, 10, 7}));
  for (const char* text : {"features.count", "features.count=", "features.count=5", "features.count=1:2:3:4",
                           "features.count=1:x", "=1:2", "features.count=1:nan", "features.count=1:2:"})
    EXPECT_THAT([text] { (void)sweep_range(text); },
                ThrowsMessage<InputError>(HasSubstr("is no range of a parameter")))
        << text;
  for (const char* text : {"features.count=1:2:0", "features.count=1:2:2.5", "features.count=1:2:5000"})
    EXPECT_THAT([text] { (void)sweep_range(text); },
                ThrowsMessage<InputError>(HasSubstr("expected 1 to 1000")))
        << text;
}

TEST(SweepValues, AreEvenOrByFactorsAndEachOnce) {
  const Config config;
  EXPECT_THAT(sweep_values(config, {"tracking.match_ratio", 0.5, 0.9, 3}),
              ElementsAre(DoubleNear(0.5, 1e-12), DoubleNear(0.7, 1e-12), DoubleNear(0.9, 1e-12)));
  EXPECT_THAT(sweep_values(config, {"features.count", 1000, 1003, 9}), ElementsAre(1000, 1001, 1002, 1003));
  EXPECT_THAT(sweep_values(config, {"tracking.pnp_iterations", 10, 1000, 3}), ElementsAre(10, 100, 1000));
  EXPECT_THAT(sweep_values(config, {"tracking.soft_weights", 0, 1, 7}), ElementsAre(0, 1));
  // From high to low is from low to high.
  EXPECT_THAT(sweep_values(config, {"features.count", 1002, 1000, 3}), ElementsAre(1000, 1001, 1002));
}

TEST(SweepValues, RefuseWhatTheParameterDoesNotAllow) {
  const Config config;
  const auto refused = [&config](const SweepRange& range, const char* why) {
    EXPECT_THAT([&] { (void)sweep_values(config, range); }, ThrowsMessage<InputError>(HasSubstr(why)));
  };
  refused({"features.nothing", 0, 1, 3}, "there is no parameter features.nothing");
  refused({"run.method", 0, 1, 3}, "run.method is no number");
  refused({"features.count", -5, 1000, 3}, "features.count goes from");
}

TEST(UsualSweep, GoesAroundTheValue) {
  Config config;
  config.features.count = 1000;
  const SweepRange range = usual_sweep(config, "features.count");
  EXPECT_EQ(range.low, 250);
  EXPECT_EQ(range.high, 4000);
  EXPECT_THROW((void)usual_sweep(config, "run.method"), InputError);
}

TEST(Sweep, EachValueIsARunOfItsOwn) {
  const auto source = rendered("walking_xyz", 40);
  Config config;
  config.run.method = "oracle";
  config.features.count = 600;
  std::vector<SweepPoint> points;
  int frames = 0;
  for (const double value : {400.0, 600.0})
    points.push_back(
        sweep_point(*source, config, "features.count", value, 36, nullptr, [&frames](const FrameResult&) {
          ++frames;
        }).value());
  EXPECT_EQ(frames, 72);
  // At the config's own value it is the config's own run.
  RunOptions options;
  options.count = 36;
  const RunReport own = report_on(run_sequence(*source, config, options), *source);
  EXPECT_EQ(points[1].reached.hash, own.hash);
  EXPECT_NE(points[0].reached.hash, own.hash);
  ASSERT_TRUE(points[0].reached.rpe_m && points[1].reached.rpe_m);
  EXPECT_EQ(best_of(points), *points[0].reached.rpe_m < *points[1].reached.rpe_m ? 0U : 1U);
  const auto json = sweep_json("walking_xyz", {"features.count", 400, 600, 2}, points);
  EXPECT_EQ(json["points"].size(), 2U);
  EXPECT_EQ(json["points"][1]["run_hash"], own.hash);
  EXPECT_EQ(sweep_table({"features.count", 400, 600, 2}, points).rows[1][0], "600");
  EXPECT_EQ(sweep_table({"features.count", 400, 600, 2}, points).rows[1][2], "7");  // 36 frames of 30 Hz
  const std::atomic<bool> stop = true;
  EXPECT_FALSE(sweep_point(*source, config, "features.count", 600, 36, &stop));
}

TEST(Sweep, WhatARangeDoesNotGiveIsTold) {
  const Config config;
  const auto remarks = [&config](const char* text) {
    const SweepRange range = sweep_range(text);
    return sweep_remarks(config, range, sweep_values(config, range));
  };
  using ::testing::ElementsAre;
  EXPECT_THAT(remarks("features.count=400:600:3"), ElementsAre());
  EXPECT_THAT(remarks("features.count=500:500:1"), ElementsAre());
  EXPECT_THAT(remarks("features.count=500:1000:1"),
              ElementsAre(::testing::HasSubstr("the lower end alone, 500")));
  EXPECT_THAT(remarks("features.count=1000:500"),
              ElementsAre(::testing::HasSubstr("go up, from 500 to 1000")));
  EXPECT_THAT(remarks("features.count=500:502:7"),
              ElementsAre(::testing::HasSubstr("there are 3 values and no 7")));
  EXPECT_THAT(remarks("tracking.soft_weights=0:1:7"), ElementsAre()) << "on and off are all there are";
}

TEST(Sweep, TheBestKeptAsManyFramesAsAny) {
  const auto point = [](double value, std::optional<double> rpe, double coverage) {
    SweepPoint one{value, {}};
    one.reached.rpe_m = rpe, one.reached.coverage = coverage;
    return one;
  };
  EXPECT_EQ(best_of({}), std::nullopt);
  EXPECT_EQ(best_of({point(1, std::nullopt, 1.0)}), std::nullopt);
  EXPECT_EQ(best_of({point(1, 0.001, 0.5), point(2, 0.02, 1.0), point(3, 0.01, 1.0)}), 2U);
}

}  // namespace
}  // namespace stillpoint
