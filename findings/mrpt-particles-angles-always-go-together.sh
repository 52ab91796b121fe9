#!/usr/bin/env bash
# MRPT's covariance of 3-D particles has yaw and pitch rise together, even where one falls as the other rises
#
# One would swear: getCovarianceAndMean of CPose3DPDFParticles is the mean of the products of the deviations, the
#   angles' taken round the circle; of particles whose angles are independent, covariances are about zero.
# What happens: the angles' deviations are made positive before they are multiplied. All six variances are right, and
#   those of positions and angles, and angles that are independent correlate by 0.64, which is 2 / pi, the mean of |a b|
#   of two Gaussian numbers; with a correlation of 0.5 they have 0.72, with -0.5 they have 0.72 too, and with -0.9 they have 0.92. So it
#   is for roll if the mean roll is above zero; below zero its covariances are right.
#   CPose3DPDFGaussian::copyFrom hands it on.
# What follows: a Gaussian made of particles is a thin one along a slant that nobody has measured: yaw plus pitch
#   is 1.3 times as uncertain as it should be and yaw less pitch 0.6 times as much, which is what opens or shuts gates. The
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

#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPose3DPDFParticles.h>

using namespace mrpt::poses;

int main() {
  const int n = 40000;
  bool ok = true;
  for (const double rho : {0.0, 0.5, -0.5, -0.9}) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    CPose3DPDFParticles particles(n);
    particles.resetDeterministic(mrpt::math::TPose3D(0, 0, 0, 0, 0, 0), n);
    double sum[2] = {0, 0}, product = 0, square[2] = {0, 0};
    for (auto& p : particles.m_particles) {
      const double a = normal(random), b = rho * a + std::sqrt(1 - rho * rho) * normal(random);
      const double x = normal(random), y = rho * x + std::sqrt(1 - rho * rho) * normal(random);
      p.d = mrpt::math::TPose3D(1 + 0.02 * x, 2 + 0.01 * y, 3 + 0.01 * normal(random), 0.5 + 0.02 * a, 0.3 + 0.01 * b, 0.2 + 0.01 * normal(random));
      p.log_w = 0;
      sum[0] += a / n, sum[1] += b / n, product += a * b / n, square[0] += a * a / n, square[1] += b * b / n;
    }
    const double right = (product - sum[0] * sum[1]) / std::sqrt((square[0] - sum[0] * sum[0]) * (square[1] - sum[1] * sum[1]));
    const auto [c, mean] = particles.getCovarianceAndMean();
    CPose3DPDFGaussian copy;
    copy.copyFrom(particles);
    const auto correlation = [](const auto& m, int i, int j) { return m(i, j) / std::sqrt(m(i, i) * m(j, j)); };
    const double angles = correlation(c, 3, 4), positions = correlation(c, 0, 1), roll = correlation(c, 3, 5), mixed = correlation(c, 0, 3);
    std::printf("seen, yaw and pitch drawn with %.3f: %.3f, as a Gaussian %.3f; yaw and roll drawn with 0: %.3f; x and y drawn with %.1f: %.3f; x and yaw %.3f; "
                "sigmas %.4f %.4f\n", right, angles, correlation(copy.cov, 3, 4), roll, rho, positions, mixed, std::sqrt(c(3, 3)), std::sqrt(c(4, 4)));
    const double sizes = 2 / M_PI * (std::sqrt(1 - rho * rho) + rho * std::asin(rho));  // mean of |a b|
    ok = ok && std::abs(right - rho) < 0.02 && std::abs(angles - sizes) < 0.02 && std::abs(roll - 2 / M_PI) < 0.02 && std::abs(positions - rho) < 0.02 &&
         std::abs(mixed) < 0.02 && std::abs(correlation(copy.cov, 3, 4) - angles) < 0.02 && std::abs(std::sqrt(c(3, 3)) / 0.02 - 1) < 0.02 &&
         std::abs(std::sqrt(c(4, 4)) / 0.01 - 1) < 0.02;
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
