#!/usr/bin/env bash
# OpenCV's Gaussian noise is positive for points in the upper half of the picture: it is the number drawn before
#
# One would swear: RNG::gaussian after RNG::uniform gives two independent numbers; whatever one
#   thinks of the generator, a simulation of points with noise, drawn in turn, has noise that does
#   not know the points.
# What happens: uniform(float, float) steps the generator and makes a float of its state; gaussian
#   makes its number of the state as it finds it and steps afterwards. Both are of the same 32 bits:
#   in 1000000 pairs, with any seed, they correlate by -0.46, and the sign of the noise is that of
#   (a half less the uniform number) nearly always. For p = (uniform(0.f, 640.f), uniform(0.f,
#   480.f)) and noise drawn after it, it is y and the noise in x. A motion by zero, fitted to 100000
#   such points with noise of half a pixel, is a shear of 0.0017 (0.8 pixels across the picture) and
#   a rotation of 0.034 degrees; it should be a hundredth of that. uniform of double or int before
#   gaussian, one more gaussian between, whole matrices by fill, and std::mt19937 are right.
# What follows: tests and Monte Carlo trials of pose, calibration and flow that draw both from one
#   RNG see biases and covariances that no estimator has. Points and noise are to come from two
#   generators, or from fill. Residuals of a fit that are smaller than the noise put in are the
#   sign.
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
want libopencv-core-dev 4.6.0
want g++ 4:12
cd "$tmp" || exit 2
echo "expected: correlations of 0.00, and no motion"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdio>
#include <random>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

template <class Draw>
std::pair<double, double> related(Draw draw) {  // correlation of two numbers, and how often noise is positive just where the first is small
  const int n = 1000000;
  double a = 0, b = 0, aa = 0, bb = 0, ab = 0, same = 0;
  for (int i = 0; i < n; ++i) {
    const auto [u, g] = draw();
    a += u, b += g, aa += u * u, bb += g * g, ab += u * g, same += (u < 0.5) == (g > 0);
  }
  return {(ab / n - a / n * b / n) / std::sqrt((aa / n - a / n * a / n) * (bb / n - b / n * b / n)), same / n};
}

template <class Point, class Noise>
cv::Vec2d motion(Point point, Noise noise) {  // d(x) / dy and the rotation in degrees, by least squares, of points that do not move
  const int n = 100000;
  double yy = 0, xy = 0, turn = 0, rr = 0;
  for (int i = 0; i < n; ++i) {
    const cv::Point2d p = point() - cv::Point2d(320, 240);
    const double dx = 0.5 * noise(), dy = 0.5 * noise();
    yy += p.y * p.y, xy += p.y * dx, turn += p.x * dy - p.y * dx, rr += p.dot(p);
  }
  return {xy / yy, turn / rr * 180 / CV_PI};
}

int main() {
  bool ok = true;
  for (const unsigned long long seed : {1ull, 12345ull, ~0ull}) {
    cv::RNG r(seed);
    const auto floats = related([&] { const double u = r.uniform(0.f, 1.f); return std::make_pair(u, r.gaussian(1)); });
    const auto doubles = related([&] { const double u = r.uniform(0.0, 1.0); return std::make_pair(u, r.gaussian(1)); });
    const auto ints = related([&] { const double u = r.uniform(0, 1000) / 1000.0; return std::make_pair(u, r.gaussian(1)); });
    const auto second = related([&] { const double u = r.uniform(0.f, 1.f); r.gaussian(1); return std::make_pair(u, r.gaussian(1)); });
    std::printf("seen, seed %llx: gaussian after uniform of float %.3f, signs agree in %.1f %%; of double %.3f, of int %.3f; the second gaussian %.3f\n", seed,
                floats.first, 100 * floats.second, doubles.first, ints.first, second.first);
    ok = ok && floats.first < -0.44 && floats.first > -0.48 && floats.second > 0.95;
    for (const auto& x : {doubles, ints, second}) ok = ok && std::abs(x.first) < 0.01 && std::abs(x.second - 0.5) < 0.01;
  }
  cv::RNG r(1);
  cv::Mat_<float> u(1000, 1000), g(1000, 1000);
  r.fill(u, cv::RNG::UNIFORM, 0, 1), r.fill(g, cv::RNG::NORMAL, 0, 1);
  int i = 0;
  const auto filled = related([&] { const int k = i++; return std::make_pair(double(u(k / 1000, k % 1000)), double(g(k / 1000, k % 1000))); });
  std::mt19937 m(1);
  std::uniform_real_distribution<double> x(0, 640), y(0, 480);
  std::normal_distribution<double> normal;
  const cv::Vec2d bad = motion([&] { const float px = r.uniform(0.f, 640.f); return cv::Point2d(px, r.uniform(0.f, 480.f)); }, [&] { return r.gaussian(1); });
  const cv::Vec2d good = motion([&] { const double px = x(m); return cv::Point2d(px, y(m)); }, [&] { return normal(m); });
  std::printf("seen, by fill: %.3f. A motion of none: shear %.5f and rotation %.4f degrees by cv::RNG, %.5f and %.4f by std::mt19937\n", filled.first, bad[0],
              bad[1], good[0], good[1]);
  return ok && std::abs(filled.first) < 0.01 && bad[0] < -0.0014 && bad[1] > 0.02 && std::abs(good[0]) < 0.0001 && std::abs(good[1]) < 0.002 ? 0 : 1;
}
CPP
g++ -w -O1 -std=c++17 -isystem /usr/include/opencv4 t.cpp -o t -lopencv_core >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: the noise is the number before it"
