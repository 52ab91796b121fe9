#!/usr/bin/env bash
# MRPT's inverse of a pose in information form knows its heading to 6.1 degrees instead of 1.7, and is NaN in 3-D
#
# One would swear: inverse() of CPosePDFGaussianInf gives the information matrix of the inverse
#   pose, which is the inverse of the covariance that CPosePDFGaussian's inverse() gives; at the
#   least it is right twice over.
# What happens: the mean is right. The matrix is turned by the Jacobian as a covariance would be, H
#   L H', where information needs the inverse of H: for a pose at (1, 2) with sigmas of 5 cm, 2 cm
#   and 1.7 degrees the inverse has 6.1 degrees in heading, which no change of origin can do, and
#   3.6 cm in y where 7.1 are right. inverse() of inverse() gives the first matrix back, as H is its
#   own inverse, so that the usual test is content. +=, -= and inverseComposition of the same class
#   are right. CPose3DPDFGaussianInf::inverse() gives NaN throughout; CPose3DPDFGaussian's is right.
# What follows: pose graphs are kept in information form, and an edge that is walked from its other
#   end is inverted. That must go by the covariance: copyFrom into CPosePDFGaussian, inverse there,
#   and back.
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
want libmrpt-poses-dev 1:2.5.8
want libmrpt-bayes-dev 1:2.5.8
want libeigen3-dev 3.4.0
want g++ 4:12
cd "$tmp" || exit 2
echo "expected: the same uncertainty by covariance and by information"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdio>

#include <Eigen/Dense>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPose3DPDFGaussianInf.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/poses/CPosePDFGaussianInf.h>

using namespace mrpt::poses;

int main() {
  CPosePDFGaussian pose, right, got, sum, sum_right, other;
  pose.mean = CPose2D(1, 2, 0.7);
  pose.cov.setZero();
  pose.cov(0, 0) = 0.0025, pose.cov(1, 1) = 0.0004, pose.cov(2, 2) = 0.0009;
  pose.inverse(right);
  CPosePDFGaussianInf form, inverse, twice;
  form.copyFrom(pose);
  form.inverse(inverse);
  inverse.inverse(twice);
  got.copyFrom(inverse);
  const auto sigma = [](const CPosePDFGaussian& g, int i) { return std::sqrt(g.cov(i, i)); };
  const double degree = std::acos(-1.0) / 180;
  std::printf("seen, sigmas of the inverse by covariance: %.4f %.4f m, %.2f degrees; by information: %.4f %.4f m, %.2f degrees; means off by %.1g\n", sigma(right, 0),
              sigma(right, 1), sigma(right, 2) / degree, sigma(got, 0), sigma(got, 1), sigma(got, 2) / degree, (right.mean - got.mean).norm());
  const double c = std::cos(0.7), s = std::sin(0.7);
  Eigen::Matrix3d h;  // the inverse's derivative
  h << -c, -s, s * 1 - c * 2, s, -c, c * 1 + s * 2, 0, 0, -1;
  const Eigen::Matrix3d l = form.cov_inv.asEigen(), m = inverse.cov_inv.asEigen(), k = pose.cov.asEigen(), r = right.cov.asEigen();
  std::printf("seen: covariance less H C H' %.1g, information less H L H' %.1g; inverted twice off by %.1g\n", (r - h * k * h.transpose()).norm(),
              (m - h * l * h.transpose()).norm() / m.norm(), (twice.cov_inv.asEigen() - l).norm() / l.norm());
  bool ok = (r - h * k * h.transpose()).norm() < 1e-9 && (m - h * l * h.transpose()).norm() / m.norm() < 1e-9 &&
            (twice.cov_inv.asEigen() - l).norm() / l.norm() < 1e-9 && std::abs(sigma(right, 2) - 0.03) < 1e-9 && sigma(got, 2) > 0.1;
  other.mean = CPose2D(-1, 0.5, 1.2), other.cov = right.cov;
  CPosePDFGaussianInf other_form, sum_form = form;
  other_form.copyFrom(other);
  sum_form += other_form;
  sum.copyFrom(sum_form), sum_right = pose + other;
  const double composed = (sum.cov.asEigen() - sum_right.cov.asEigen()).norm() / sum_right.cov.asEigen().norm();
  CPose3DPDFGaussian solid, solid_right;
  solid.mean = CPose3D(1, 2, 3, 0.5, 0.3, -0.2);
  solid.cov.setZero();
  for (int i = 0; i < 6; ++i) solid.cov(i, i) = 1e-4 * (i + 1);
  solid.inverse(solid_right);
  CPose3DPDFGaussianInf solid_form, solid_inverse;
  solid_form.copyFrom(solid);
  solid_form.inverse(solid_inverse);
  int bad = 0;
  for (int i = 0; i < 6; ++i) bad += !std::isfinite(solid_inverse.cov_inv(i, i));
  std::printf("seen: += by information is off by %.1g; in 3-D %d of 6 on the diagonal of the inverse's information are no numbers, by covariance %s\n", composed,
              bad, solid_right.cov.asEigen().allFinite() ? "all are" : "some are not");
  return ok && composed < 1e-9 && bad == 6 && solid_right.cov.asEigen().allFinite() ? 0 : 1;
}
CPP
inc=$(printf -- '-I%s ' /usr/include/mrpt/*/include)
# shellcheck disable=SC2086
g++ -w -O1 -std=c++17 $inc -I/usr/include/eigen3 t.cpp -o t -lmrpt-poses -lmrpt-bayes -lmrpt-math -lmrpt-system -lmrpt-random -lmrpt-core \
  -lmrpt-serialization -lmrpt-rtti >cc.log 2>&1 || { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: information is turned like covariance"
