// The one descent behind eq. (4), eq. (5) and bundle adjustment.
#include "core/geometry/levenberg_marquardt.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

namespace stillpoint {
namespace {

/// Rosenbrock's valley as squares: r = (10 (y - x²), 1 - x), least at (1, 1). Beyond `wall` it has no cost.
struct Valley {
  Eigen::Vector2d at{-1.2, 1.0}, before = at, change = Eigen::Vector2d::Zero();
  double wall = std::numeric_limits<double>::infinity();
  int undone = 0, steps = 0;
  Eigen::Matrix2d h, h_before;
  Eigen::Vector2d g, g_before;

  double linearise() {
    if (at.x() > wall) return std::numeric_limits<double>::infinity();
    const Eigen::Vector2d r(10.0 * (at.y() - at.x() * at.x()), 1.0 - at.x());
    Eigen::Matrix2d j;
    j << -20.0 * at.x(), 10.0, -1.0, 0.0;
    h = j.transpose() * j, g = j.transpose() * r;
    return r.squaredNorm();
  }
  double step(double damping) {
    ++steps;
    before = at, h_before = h, g_before = g;
    const Eigen::Vector2d added = damping * h.diagonal();
    Eigen::Matrix2d damped = h;
    damped.diagonal() += added;
    change = -damped.inverse() * g;
    const double foreseen = added.dot(change.cwiseAbs2()) - g.dot(change);
    if (foreseen > 0) at += change;
    return foreseen;
  }
  void undo() { ++undone, at = before, h = h_before, g = g_before; }
  [[nodiscard]] bool converged(double, double) const { return change.norm() < 1e-9; }
};

TEST(LevenbergMarquardt, GoesDownABentValley) {
  Valley valley;
  const Descent descent = levenberg_marquardt(valley, 100);
  EXPECT_TRUE(descent.begun);
  EXPECT_NEAR((valley.at - Eigen::Vector2d(1, 1)).norm(), 0.0, 1e-8);
  EXPECT_GT(valley.undone, 0) << "the valley is bent: some step must lead up its side";
  EXPECT_EQ(descent.tried - descent.taken, valley.undone);
  EXPECT_LT(descent.tried, 40);
}

TEST(LevenbergMarquardt, NeverEndsWhereThereIsNoCost) {
  Valley valley;
  valley.wall = 0.5;
  const Descent descent = levenberg_marquardt(valley, 100);
  EXPECT_TRUE(descent.begun);
  EXPECT_LE(valley.at.x(), 0.5);
  EXPECT_GT(valley.at.x(), 0.4) << "the least cost that there is lies at the wall";
}

TEST(LevenbergMarquardt, DoesNotBeginWhereThereIsNoCost) {
  Valley valley;
  valley.wall = -2.0;
  const Descent descent = levenberg_marquardt(valley, 100);
  EXPECT_FALSE(descent.begun);
  EXPECT_EQ(valley.steps, 0);
  EXPECT_EQ(valley.at, Eigen::Vector2d(-1.2, 1.0));
}

TEST(LevenbergMarquardt, TriesNoMoreStepsThanItIsGiven) {
  Valley valley;
  const double cost = valley.linearise();
  const Descent descent = levenberg_marquardt(valley, 12);
  EXPECT_EQ(descent.tried, 12);
  EXPECT_LT(valley.linearise(), cost);
}

TEST(LevenbergMarquardt, StaysAtAMinimum) {
  Valley valley;
  valley.at = {1, 1};
  const Descent descent = levenberg_marquardt(valley, 10);
  EXPECT_TRUE(descent.begun);
  EXPECT_EQ(descent.taken, 0);
  EXPECT_EQ(valley.at, Eigen::Vector2d(1, 1));
}

}  // namespace
}  // namespace stillpoint
