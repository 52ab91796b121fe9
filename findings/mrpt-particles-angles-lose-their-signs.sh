#!/usr/bin/env bash
# MRPT's covariance of particles has no correlation of place and heading, or that of the other sign
#
# One would swear: getCovarianceAndMean of CPosePDFParticles and CPose3DPDFParticles is the mean of
#   the products of the deviations, those of angles taken round the circle. It is what a robot that
#   drives a curve is judged by: where it may be goes with where it may be heading.
# What happens: the deviations of angles are made positive before they are multiplied. Variances are
#   right, and so are covariances of positions. x and heading drawn with a correlation of -0.8 or of
#   0.8 have 0.00 if the mean heading is positive, and 0.80 or -0.80, the wrong sign, if it is
#   negative, in 2-D and in 3-D. Independent yaw and pitch of positive means have 0.64, which is 2 /
#   pi, the mean of |a b| of two Gaussian numbers, and ones drawn with -0.8 or 0.8 have 0.86; if one
#   of the means is negative they have none. What copyFrom makes of particles has the same.
# What follows: the ellipse of a localisation by particles loses or mirrors its slant as the robot
#   turns past 0. Gates and fusions by it are wrong in the one term that matters on curves; the
#   covariance should be worked out from the particles themselves.
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
echo "expected: the correlations that the particles were drawn with"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdio>
#include <random>

#include <mrpt/poses/CPose3DPDFParticles.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/poses/CPosePDFParticles.h>

using namespace mrpt::poses;

int main() {
  const int n = 40000;
  bool ok = true;
  for (const double mean : {0.5, -0.5})
    for (const double rho : {-0.8, 0.8, 0.0}) {
      std::mt19937 random(1);
      std::normal_distribution<double> normal;
      CPosePDFParticles flat(n);
      CPose3DPDFParticles solid(n);
      solid.resetDeterministic(mrpt::math::TPose3D(0, 0, 0, 0, 0, 0), n);
      double product = 0, aa = 0, bb = 0;
      for (int i = 0; i < n; ++i) {
        const double a = normal(random), b = rho * a + std::sqrt(1 - rho * rho) * normal(random), c = normal(random);
        const double y = rho * a + std::sqrt(1 - rho * rho) * normal(random), pitch = rho * b + std::sqrt(1 - rho * rho) * normal(random);
        flat.m_particles[i].d = mrpt::math::TPose2D(1 + 0.1 * a, 2 + 0.1 * y, mean + 0.05 * b);
        solid.m_particles[i].d = mrpt::math::TPose3D(1 + 0.1 * a, 2 + 0.1 * y, 0.1 * c, mean + 0.05 * b, 0.3 + 0.05 * pitch, 0.1 + 0.05 * normal(random));
        flat.m_particles[i].log_w = solid.m_particles[i].log_w = 0;
        product += a * b, aa += a * a, bb += b * b;
      }
      const auto correlation = [](const auto& m, int i, int j) { return m(i, j) / std::sqrt(m(i, i) * m(j, j)); };
      const auto [two, mean_two] = flat.getCovarianceAndMean();
      const auto [three, mean_three] = solid.getCovarianceAndMean();
      CPosePDFGaussian copy;
      copy.copyFrom(flat);
      const double right = product / std::sqrt(aa * bb), x_phi = correlation(two, 0, 2), x_yaw = correlation(three, 0, 3), angles = correlation(three, 3, 4);
      std::printf("seen, mean heading %g, drawn with %.2f: x and heading %.2f, as a Gaussian %.2f, x and yaw in 3-D %.2f, yaw and pitch %.2f; x and y %.2f; "
                  "sigmas of the angles %.4f %.4f\n", mean, right, x_phi, correlation(copy.cov, 0, 2), x_yaw, angles, correlation(two, 0, 1),
                  std::sqrt(two(2, 2)), std::sqrt(three(3, 3)));
      const double place = mean > 0 ? 0 : -rho;
      const double sizes = 2 / M_PI * (std::sqrt(1 - rho * rho) + rho * std::asin(rho));  // mean of |a b|
      ok = ok && std::abs(right - rho) < 0.02 && std::abs(correlation(two, 0, 1) - rho) < 0.02 && std::abs(std::sqrt(two(2, 2)) / 0.05 - 1) < 0.02 &&
           std::abs(std::sqrt(three(3, 3)) / 0.05 - 1) < 0.02;
      for (const double c : {x_phi, x_yaw, correlation(copy.cov, 0, 2)}) ok = ok && std::abs(c - place) < 0.02;
      if (mean > 0) ok = ok && std::abs(angles - sizes) < 0.02;
    }
  return ok ? 0 : 1;
}
CPP
inc=$(printf -- '-I%s ' /usr/include/mrpt/*/include)
# shellcheck disable=SC2086
g++ -w -O1 -std=c++17 $inc -I/usr/include/eigen3 t.cpp -o t -lmrpt-poses -lmrpt-bayes -lmrpt-math -lmrpt-system -lmrpt-random -lmrpt-core \
  -lmrpt-serialization -lmrpt-rtti >cc.log 2>&1 || { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: only the sizes of the angles' deviations are multiplied"
