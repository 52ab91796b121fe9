#pragma once

#include <Eigen/Core>
#include <optional>

namespace stillpoint {

/// The solution x of h x = g by Cholesky's decomposition with pivots (LDL^T). Compiled once for each size: a
/// file that decomposes by itself takes four seconds longer to compile.
/// @param h symmetric and positive semidefinite @param g as many rows; sizes are 3, 4, 6, 8 or dynamic
template <int Size>
[[nodiscard]] Eigen::Matrix<double, Size, 1> solve_ldlt(const Eigen::Matrix<double, Size, Size>& h,
                                                        const Eigen::Matrix<double, Size, 1>& g);

/// The same, or nothing where h is not semidefinite or the solution not finite. The size is 6.
template <int Size>
[[nodiscard]] std::optional<Eigen::Matrix<double, Size, 1>> try_solve_ldlt(
    const Eigen::Matrix<double, Size, Size>& h, const Eigen::Matrix<double, Size, 1>& g);

/// Column by column, of one decomposition.
[[nodiscard]] Eigen::MatrixXd solve_ldlt(const Eigen::MatrixXd& h, const Eigen::MatrixXd& g);

/// The largest standard deviation in any direction: the root of the covariance's largest eigenvalue.
[[nodiscard]] double largest_deviation(const Eigen::Matrix3d& covariance);

}  // namespace stillpoint
