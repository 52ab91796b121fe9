#include "core/odometry/adaptive_kernel.hpp"

#include <array>
#include <cmath>

namespace stillpoint {
namespace {

constexpr int kShapes = 31;  // shapes that are tried, from -4 to 2: those between are alike
// The kernel's shape: below the least, shapes hardly differ, nor do they within a step.
constexpr double kLeastShape = -4.0, kShapeStep = 0.2;
// Standard deviations: the integral needs an end, as it diverges for shapes below 0.
constexpr double kCutOff = 10.0;

double shape_at(int i) { return kLeastShape + kShapeStep * i; }

/// log of the integral of exp(-cost) over [-kCutOff, kCutOff], a shape each.
std::array<double, kShapes> log_partitions() {
  constexpr int kSteps = 2000;  // of the midpoint rule: 1/200 of a standard deviation each
  std::array<double, kShapes> logs{};
  for (int s = 0; s < kShapes; ++s) {
    const AdaptiveKernel kernel(shape_at(s));
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      const double x = kCutOff * (i + 0.5) / kSteps;
      sum += std::exp(-kernel.cost(x * x));
    }
    logs[static_cast<std::size_t>(s)] = std::log(2.0 * kCutOff * sum / kSteps);
  }
  return logs;
}

}  // namespace

AdaptiveKernel AdaptiveKernel::likeliest(const std::vector<double>& squares) {
  static const std::array<double, kShapes> partitions = log_partitions();
  double best = 1.0, least = INFINITY;
  for (int s = 0; s < kShapes; ++s) {
    const AdaptiveKernel kernel(shape_at(s));
    double surprise = 0.0;
    int count = 0;
    for (const double square : squares)
      if (square < kCutOff * kCutOff) surprise += kernel.cost(square), ++count;
    surprise += count * partitions[static_cast<std::size_t>(s)];
    if (count > 0 && surprise < least) least = surprise, best = kernel.shape_;
  }
  return AdaptiveKernel(best);
}

double AdaptiveKernel::cost(double square) const {
  constexpr double kSame = 1e-9;  // of the shape: where the formula divides 0 by 0, its limit
  if (std::abs(shape_ - 2.0) < kSame) return 0.5 * square;
  const double aside = std::abs(shape_ - 2.0), grown = square / aside + 1.0;
  if (std::abs(shape_) < kSame) return std::log(grown);
  return aside / shape_ * (std::pow(grown, 0.5 * shape_) - 1.0);
}

double AdaptiveKernel::weight(double square) const {
  constexpr double kSame = 1e-9;  // of the shape: where the formula divides 0 by 0, its limit
  if (std::abs(shape_ - 2.0) < kSame) return 1.0;
  return std::pow(square / std::abs(shape_ - 2.0) + 1.0, 0.5 * shape_ - 1.0);
}

}  // namespace stillpoint
