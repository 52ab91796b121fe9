#pragma once

#include <vector>

namespace stillpoint {

/// The general robust loss (Barron 2019) of scale 1: squares for shape 2, Charbonnier's for 1, Cauchy's for
/// 0, Geman and McClure's for -2, and all between; its shape is taken from the residuals themselves.
class AdaptiveKernel {
 public:
  explicit AdaptiveKernel(double shape) : shape_(shape) {}

  /// The shape under which residuals are likeliest, of 31 from -4 to 2. Densities are cut off at 10 standard
  /// deviations, beyond which no residual counts, so that shapes below 0 have one too (Chebrolu et al. 2021).
  /// @param squares of residuals in standard deviations; of none, 1
  [[nodiscard]] static AdaptiveKernel likeliest(const std::vector<double>& squares);

  [[nodiscard]] double shape() const { return shape_; }
  /// @param square of a residual in standard deviations
  [[nodiscard]] double cost(double square) const;
  /// Its derivative by half the square: what the square is weighed by in Gauss-Newton.
  [[nodiscard]] double weight(double square) const;

 private:
  double shape_;
};

}  // namespace stillpoint
