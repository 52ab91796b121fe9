#include "ui/plot/plot_axis.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "ui/plot/path_plot.hpp"
#include "ui/plot/plot_view.hpp"

namespace stillpoint {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> labels(const std::vector<AxisTick>& ticks) {
  std::vector<std::string> texts;
  for (const AxisTick& tick : ticks) {
    if (!tick.label.empty()) texts.push_back(tick.label);
  }
  return texts;
}

TEST(LinearTicksTest, RoundNumbersWithJustEnoughDigits) {
  EXPECT_THAT(labels(linear_ticks({0.0, 10.0}, 6)), ElementsAre("0", "2", "4", "6", "8", "10"));
  EXPECT_THAT(labels(linear_ticks({0.0, 0.11}, 3)), ElementsAre("0", "0.05", "0.10"));
  EXPECT_THAT(labels(linear_ticks({-1.3, 1.3}, 5)), ElementsAre("-1", "0", "1"));
  EXPECT_THAT(labels(linear_ticks({0.0, 900.0}, 5)), ElementsAre("0", "200", "400", "600", "800"));
}

TEST(LinearTicksTest, NeverMoreThanAskedAndAlwaysInside) {
  for (const AxisRange range :
       {AxisRange{0.0, 1.0}, {0.13, 0.14}, {-5e5, 3e6}, {1e-7, 4e-7}, {99.99, 100.01}}) {
    for (int most = 2; most < 12; ++most) {
      const auto ticks = linear_ticks(range, most);
      EXPECT_LE(static_cast<int>(ticks.size()), most);
      EXPECT_FALSE(ticks.empty());
      for (const AxisTick& tick : ticks) {
        EXPECT_GE(tick.value, range.low - 1e-6 * range.span());
        EXPECT_LE(tick.value, range.high + 1e-6 * range.span());
      }
    }
  }
}

TEST(LinearTicksTest, OfWholeNumbersAreWhole) {
  std::vector<std::string> labels;
  for (const AxisTick& tick : linear_ticks({-0.5, 2.5}, 20, 1.0)) labels.push_back(tick.label);
  EXPECT_EQ(labels, (std::vector<std::string>{"0", "1", "2"}));
  EXPECT_EQ(linear_ticks({-0.5, 299.5}, 8, 1.0).size(), linear_ticks({-0.5, 299.5}, 8).size());
}

TEST(LinearTicksTest, AScaleTakesTwo) {
  EXPECT_THAT(labels(linear_ticks({0.0, 495.0}, 2)), ElementsAre("0", "400"));
  EXPECT_THAT(labels(linear_ticks({0.0, 0.49}, 2)), ElementsAre("0", "0.4"));
  for (double high = 1.0; high < 20.0; high *= 1.03)
    for (int most = 2; most < 5; ++most) {
      const auto ticks = linear_ticks({0.0, high}, most);
      EXPECT_GE(ticks.size(), 2U) << high << ", " << most;
      EXPECT_LE(static_cast<int>(ticks.size()), most) << high;
    }
}

TEST(LinearTicksTest, NoneForARangeThatIsNone) {
  EXPECT_THAT(linear_ticks({1.0, 1.0}, 5), IsEmpty());
  EXPECT_THAT(linear_ticks({0.0, std::numeric_limits<double>::infinity()}, 5), IsEmpty());
  EXPECT_THAT(linear_ticks({std::nan(""), 1.0}, 5), IsEmpty());
}

TEST(LogTicksTest, LabelsDecadesAndFewerOfThemWhenCrowded) {
  EXPECT_THAT(labels(log_ticks({0.001, 1.0}, 6)), ElementsAre("0.001", "0.01", "0.1", "1"));
  EXPECT_THAT(labels(log_ticks({1.0, 1e8}, 4)), ElementsAre("1", "100", "10000", "1e+06", "1e+08"));
  EXPECT_THAT(labels(log_ticks({0.5, 8.0}, 6)), ElementsAre("0.5", "1", "2", "5"));
  EXPECT_THAT(log_ticks({0.0, 1.0}, 6), IsEmpty());
}

TEST(RangeOfTest, PassesOverWhatCannotBeDrawn) {
  const std::vector<double> values{2.0, std::nan(""), 6.0, std::numeric_limits<double>::infinity(), -2.0};
  EXPECT_EQ(range_of(values, 0.0, AxisScale::kLinear), (AxisRange{-2.0, 6.0}));
  EXPECT_EQ(range_of(values, 0.25, AxisScale::kLinear), (AxisRange{-4.0, 8.0}));
  EXPECT_EQ(range_of(values, 0.0, AxisScale::kLog), (AxisRange{2.0, 6.0}));
}

TEST(RangeOfTest, AlwaysHasAnExtent) {
  EXPECT_EQ(range_of(std::vector<double>{}, 0.1, AxisScale::kLinear), (AxisRange{0.0, 1.0}));
  EXPECT_EQ(range_of(std::vector<double>{4.0}, 0.1, AxisScale::kLinear), (AxisRange{2.0, 6.0}));
  EXPECT_EQ(range_of(std::vector<double>{0.0, 0.0}, 0.1, AxisScale::kLinear), (AxisRange{-1.0, 1.0}));
  EXPECT_EQ(range_of(std::vector<double>{4.0}, 0.1, AxisScale::kLog), (AxisRange{2.0, 8.0}));
}

TEST(AxisMapTest, MapsBothWays) {
  const AxisMap linear{{0.0, 10.0}, AxisScale::kLinear, 300.0, 100.0};
  EXPECT_DOUBLE_EQ(linear.to_pixel(0.0), 300.0);
  EXPECT_DOUBLE_EQ(linear.to_pixel(2.5), 250.0);
  const AxisMap log{{0.01, 100.0}, AxisScale::kLog, 0.0, 400.0};
  EXPECT_NEAR(log.to_pixel(1.0), 200.0, 1e-9);
  EXPECT_TRUE(std::isnan(log.to_pixel(0.0)));
  for (const double pixel : {-20.0, 0.0, 137.0, 400.0}) {
    EXPECT_NEAR(linear.to_pixel(linear.to_value(pixel)), pixel, 1e-9);
    EXPECT_NEAR(log.to_pixel(log.to_value(pixel)), pixel, 1e-9);
  }
}

TEST(AxisMapTest, ZoomKeepsTheValueUnderTheMouse) {
  for (const AxisScale scale : {AxisScale::kLinear, AxisScale::kLog}) {
    AxisMap map{{1.0, 9.0}, scale, 0.0, 800.0};
    const double under = map.to_value(200.0);
    map.range = zoomed(map, 200.0, 0.5);
    EXPECT_NEAR(map.to_value(200.0), under, 1e-9);
  }
  const AxisMap linear{{1.0, 9.0}, AxisScale::kLinear, 0.0, 800.0};
  EXPECT_EQ(zoomed(linear, 200.0, 0.5), (AxisRange{2.0, 6.0}));
}

TEST(AxisMapTest, PanMovesTheContentWithTheMouse) {
  AxisMap map{{1.0, 9.0}, AxisScale::kLinear, 0.0, 800.0};
  const double under = map.to_value(300.0);
  map.range = panned(map, 50.0);
  EXPECT_NEAR(map.to_value(350.0), under, 1e-9);
}

TEST(FormatValueTest, ReadsWell) {
  EXPECT_EQ(format_value(0.0123456, "m"), "0.01235 m");
  EXPECT_EQ(format_value(12.0, ""), "12");
  EXPECT_EQ(format_value(std::nan(""), "m"), "–");
}

TEST(DecimateTest, KeepsEverySpikeInFarFewerPoints) {
  std::vector<double> x, y;
  for (int i = 0; i < 10000; ++i) {
    x.push_back(i);
    y.push_back(i == 6543 ? 50.0 : i == 7001 ? -9.0 : 1.0);
  }
  const auto samples = decimate(x, y, {0.0, 9999.0}, 200);
  EXPECT_LE(samples.size(), 4U * 201U);
  double greatest = 0.0, least = 0.0;
  for (const PlotSample& sample : samples) {
    greatest = std::max(greatest, sample.y);
    least = std::min(least, sample.y);
  }
  EXPECT_EQ(greatest, 50.0);
  EXPECT_EQ(least, -9.0);
  EXPECT_EQ(samples.front().x, 0.0);
  EXPECT_EQ(samples.back().x, 9999.0);
}

TEST(DecimateTest, GapsStayGaps) {
  const double gap = std::nan("");
  const std::vector<double> x{0, 1, 2, 3, 4, 5}, y{1, 2, gap, gap, 3, 4};
  const auto samples = decimate(x, y, {0.0, 5.0}, 600);
  ASSERT_EQ(samples.size(), 5U);
  EXPECT_TRUE(std::isnan(samples[2].y));
  EXPECT_EQ(samples[3].y, 3.0);
}

TEST(DecimateTest, CutsToTheRangeAndOneBeyond) {
  const std::vector<double> x{0, 1, 2, 3, 4, 5}, y{0, 1, 2, 3, 4, 5};
  const auto samples = decimate(x, y, {2.5, 3.5}, 100);
  ASSERT_EQ(samples.size(), 3U);
  EXPECT_EQ(samples.front().x, 2.0);
  EXPECT_EQ(samples.back().x, 4.0);
}

TEST(NearestIndexTest, FindsTheNearest) {
  const std::vector<double> x{0.0, 1.0, 4.0};
  EXPECT_EQ(nearest_index(x, -5.0), 0U);
  EXPECT_EQ(nearest_index(x, 2.0), 1U);
  EXPECT_EQ(nearest_index(x, 3.0), 2U);
  EXPECT_EQ(nearest_index(x, 99.0), 2U);
  EXPECT_EQ(nearest_index({}, 1.0), std::nullopt);
}

TEST(PathPlot, ShowsTheTwoAxesInWhichPathsReachFurthest) {
  // One path goes along z, the other along x; neither goes far in y.
  const std::array<std::vector<double>, 3> along_z{{{0.0, 0.1}, {0.0, 0.2}, {-3.0, 3.0}}},
      along_x{{{0.0, 4.0}, {0.0, 0.1}, {0.0, 0.0}}};
  const std::vector<PlotPath> paths{{"a", &along_z, {}}, {"b", &along_x, {}}};
  const PathPlot made = path_plot(paths);
  EXPECT_STREQ(made.across, "x");
  EXPECT_STREQ(made.up, "z");
  ASSERT_EQ(made.plot.series.size(), 2U);
  EXPECT_EQ(made.plot.series[0].y.back(), 3.0);
  EXPECT_EQ(made.plot.series[1].x.back(), 4.0);
  EXPECT_TRUE(made.plot.equal_scale);
}

}  // namespace
}  // namespace stillpoint
