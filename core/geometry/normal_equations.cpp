#include "core/geometry/normal_equations.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace stillpoint {

template <int Size>
Eigen::Matrix<double, Size, 1> solve_ldlt(const Eigen::Matrix<double, Size, Size>& h,
                                          const Eigen::Matrix<double, Size, 1>& g) {
  return h.ldlt().solve(g);
}

template Eigen::Matrix<double, 3, 1> solve_ldlt<3>(const Eigen::Matrix<double, 3, 3>&,
                                                   const Eigen::Matrix<double, 3, 1>&);
template Eigen::Matrix<double, 4, 1> solve_ldlt<4>(const Eigen::Matrix<double, 4, 4>&,
                                                   const Eigen::Matrix<double, 4, 1>&);
template Eigen::Matrix<double, 6, 1> solve_ldlt<6>(const Eigen::Matrix<double, 6, 6>&,
                                                   const Eigen::Matrix<double, 6, 1>&);
template Eigen::Matrix<double, 8, 1> solve_ldlt<8>(const Eigen::Matrix<double, 8, 8>&,
                                                   const Eigen::Matrix<double, 8, 1>&);
template Eigen::VectorXd solve_ldlt<Eigen::Dynamic>(const Eigen::MatrixXd&, const Eigen::VectorXd&);

template <int Size>
std::optional<Eigen::Matrix<double, Size, 1>> try_solve_ldlt(const Eigen::Matrix<double, Size, Size>& h,
                                                             const Eigen::Matrix<double, Size, 1>& g) {
  const Eigen::LDLT<Eigen::Matrix<double, Size, Size>> solver(h);
  if (solver.info() != Eigen::Success) return std::nullopt;
  const Eigen::Matrix<double, Size, 1> solution = solver.solve(g);
  if (!solution.allFinite()) return std::nullopt;
  return solution;
}

template std::optional<Eigen::Matrix<double, 6, 1>> try_solve_ldlt<6>(const Eigen::Matrix<double, 6, 6>&,
                                                                      const Eigen::Matrix<double, 6, 1>&);

Eigen::MatrixXd solve_ldlt(const Eigen::MatrixXd& h, const Eigen::MatrixXd& g) { return h.ldlt().solve(g); }

double largest_deviation(const Eigen::Matrix3d& covariance) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

}  // namespace stillpoint
