#include "core/geometry/rotation_fit.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace stillpoint {

RotationFit fit_rotation(const Eigen::Matrix3d& sum) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) signs.z() = -1;
  return {svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose(), svd.singularValues(), svd.matrixU(),
          svd.matrixV()};
}

}  // namespace stillpoint
