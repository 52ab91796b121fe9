#!/usr/bin/env bash
# Ceres' quaternion manifolds count in half angles, covariances too
#
# One would swear: the tangent space of QuaternionManifold and of
#   EigenQuaternionManifold is the rotation vector, as in Sophus, GTSAM or
#   manif: Plus(q, d) turns by |d|, and GetCovarianceBlockInTangentSpace is in
#   radians squared.
# What happens: d is the half angle. Plus(q, 0.1) turns by 0.2 rad, and an
#   orientation known to 0.02 rad has a standard deviation of 0.01 in the tangent
#   space; as covariance a quarter. The turn is about the axes of the world
#   (left), where EigenQuaternionManifold's name suggests Eigen's habits only in
#   the order of the numbers.
# What follows: covariance ellipses, gates and NEES of rotations from Ceres'
#   tangent space must be scaled by 2 (covariance by 4) and say about which axes; a
#   NEES of rotations that sits at four times three is this and no wrong noise model.
#   The same holds for the size of a step and for priors written with Minus.
set -u
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
have() { dpkg-query -W -f '${Version}' "$1" 2>/dev/null; }
want() { # package, start of its version
  [ -n "$(have "$1")" ] || { apt-get update -qq && apt-get install -y -qq --no-install-recommends \
    -o DPkg::Lock::Timeout=300 "$1"; } >"$tmp/apt.log" 2>&1
  case $(have "$1") in
    "$2"*) echo "version: $1 $(have "$1")" ;;
    *) echo "$1 '$(have "$1")', wanted $2: not looked at"; exit 2 ;;
  esac
}
want libceres-dev 2.1.0
want libeigen3-dev 3.4.0
want g++ 4:12
echo "expected: Plus by 0.1 turns by 0.1 rad; the standard deviation is 0.02"
cat >"$tmp/t.cpp" <<'CPP'
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <memory>

// An orientation measured once, with `sigma` rad about each axis.
struct Measured {
  Eigen::Quaterniond is;
  double sigma;
  bool eigen_order;
  template <class T>
  bool operator()(const T* q, T* r) const {
    const T back[4] = {T(is.w()), T(-is.x()), T(-is.y()), T(-is.z())};
    const T eigen[4] = {q[3], q[0], q[1], q[2]}, plain[4] = {q[0], q[1], q[2], q[3]};
    T between[4];
    ceres::QuaternionProduct(back, eigen_order ? eigen : plain, between);
    ceres::QuaternionToAngleAxis(between, r);
    for (int i = 0; i < 3; ++i) r[i] /= T(sigma);
    return true;
  }
};

static Eigen::Quaterniond read(const double* q, bool eigen_order) {
  return eigen_order ? Eigen::Quaterniond(q[3], q[0], q[1], q[2]) : Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
}

int main() {
  bool as_described = true;
  const Eigen::Quaterniond truth(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  for (bool eigen_order : {false, true}) {
    double q[4] = {eigen_order ? 0.0 : 1.0, 0, 0, eigen_order ? 1.0 : 0.0};
    ceres::Manifold* manifold = eigen_order ? static_cast<ceres::Manifold*>(new ceres::EigenQuaternionManifold)
                                            : new ceres::QuaternionManifold;
    ceres::Problem problem;
    problem.AddParameterBlock(q, 4, manifold);
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Measured, 3, 4>(new Measured{truth, 0.02, eigen_order}), nullptr, q);
    ceres::Solver::Options options;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    ceres::Covariance covariance{ceres::Covariance::Options()};
    std::vector<std::pair<const double*, const double*>> blocks{{q, q}};
    double c[9];
    if (!covariance.Compute(blocks, &problem) || !covariance.GetCovarianceBlockInTangentSpace(q, q, c)) return 1;
    const double d[3] = {0.1, 0, 0};
    double moved[4];
    manifold->Plus(q, d, moved);
    const Eigen::AngleAxisd left(read(moved, eigen_order) * read(q, eigen_order).conjugate());
    std::printf("seen: %s: found to %.1e rad; Plus by 0.1 about x turns by %.4f rad about the world's (%.2f %.2f %.2f); "
                "standard deviations %.4f %.4f %.4f\n",
                eigen_order ? "EigenQuaternionManifold" : "QuaternionManifold",
                read(q, eigen_order).angularDistance(truth), left.angle(), left.axis().x(), left.axis().y(),
                left.axis().z(), std::sqrt(c[0]), std::sqrt(c[4]), std::sqrt(c[8]));
    as_described = as_described && std::abs(left.angle() - 0.2) < 1e-9 && left.axis().x() > 0.999999 &&
                   std::abs(std::sqrt(c[0]) - 0.01) < 1e-6 && std::abs(std::sqrt(c[4]) - 0.01) < 1e-6 &&
                   std::abs(std::sqrt(c[8]) - 0.01) < 1e-6;
  }
  return as_described ? 0 : 1;
}
CPP
g++ -w -I/usr/include/eigen3 "$tmp/t.cpp" -o "$tmp/t" -lceres -lglog 2>"$tmp/cc.log" ||
  { tail -5 "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
"$tmp/t" || { echo "the behaviour has changed"; exit 1; }
