#!/usr/bin/env bash
# OpenCV calibrates a rotating camera of f = 525 as 615 by 564 with a skew of 125, from exact homographies
#
# One would swear: calibrateRotatingCamera takes homographies K R K^-1 between views of a camera
#   that only turns and returns K, with principal point and skew, as its algebra allows; four exact
#   ones give K to rounding.
# What happens: it finds W = K K^T right, and takes Cholesky's factor of it, W = L L^T, transposed
#   for K. L^T has the shape of a camera matrix and is none: L^T L is not W. For f = 525 and (320,
#   240) it is (614.8, 124.9, 0.52; 0, 563.6, 0.31; 0, 0, 0.795), for f = 300 (438.6, 175.1, ..; 0,
#   342.0, ..), and it returns true. The right factor of the same W, the upper one, is K to a
#   millionth. If pixels are counted from the principal point, as the stitcher counts them from the
#   middle of the picture, both factors are diagonal and all is well; a principal point 20 pixels
#   beside the middle comes out as 0.04.
# What follows: self-calibration from pure rotation (a turning RGB-D camera, a panorama at a run's
#   start) can use it with centred pixels and a known centre only. Of K it says nothing but f; W =
#   K'^T K' of what it returns and a factorization from the lower right corner give the rest.
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
want libopencv-stitching-dev 4.6.0
want libopencv-calib3d-dev 4.6.0
want g++ 4:12
cd "$tmp" || exit 2
echo "expected: K"
cat >t.cpp <<'CPP'
#include <cmath>
#include <cstdio>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/stitching/detail/autocalib.hpp>

cv::Matx33d upper(const cv::Matx33d& w) {  // K of W = K K^T, upper triangular, by Cholesky from the last corner
  cv::Matx33d k = cv::Matx33d::zeros();
  k(2, 2) = std::sqrt(w(2, 2));
  k(1, 2) = w(1, 2) / k(2, 2), k(0, 2) = w(0, 2) / k(2, 2);
  k(1, 1) = std::sqrt(w(1, 1) - k(1, 2) * k(1, 2));
  k(0, 1) = (w(0, 1) - k(0, 2) * k(1, 2)) / k(1, 1);
  k(0, 0) = std::sqrt(w(0, 0) - k(0, 1) * k(0, 1) - k(0, 2) * k(0, 2));
  return k * (1 / k(2, 2));
}

int main() {
  bool ok = true;
  struct Camera {
    double f, x, y;
  };
  for (const Camera c : {Camera{525, 320, 240}, Camera{300, 320, 240}, Camera{525, 0, 0}, Camera{525, 20, -10}}) {
    const cv::Matx33d k(c.f, 0, c.x, 0, c.f, c.y, 0, 0, 1);
    std::vector<cv::Mat> homographies;
    for (int i = 0; i < 4; ++i) {
      cv::Matx33d r;
      cv::Rodrigues(cv::Vec3d(0.1 * i - 0.1, 0.3 - 0.1 * i, 0.05), r);
      homographies.push_back(cv::Mat(k * r * k.inv()));
    }
    cv::Mat got;
    const bool said = cv::detail::calibrateRotatingCamera(homographies, got);
    if (got.empty()) return 1;
    const cv::Matx33d g(got);
    const cv::Matx33d again = upper(g.t() * g);
    std::printf("seen, f = %g at (%g, %g): %s, (%.1f, %.1f, %.2f; 0, %.1f, %.2f; 0, 0, %.3f); the other factor of the same product is off by %.1g\n", c.f, c.x,
                c.y, said ? "true" : "false", g(0, 0), g(0, 1), g(0, 2), g(1, 1), g(1, 2), g(2, 2), cv::norm(again - k));
    ok = ok && said && cv::norm(again - k) < 1e-3;
    if (c.x > 100)
      ok = ok && std::abs(g(0, 0) - std::hypot(c.f, c.x)) < 0.01 && std::abs(g(0, 1)) > 100 && std::abs(g(0, 2)) < 1;
    else
      ok = ok && std::abs(g(0, 0) - c.f) < 0.5 && std::abs(g(0, 2)) < 0.05;
  }
  return ok ? 0 : 1;
}
CPP
g++ -w -O1 -std=c++17 -isystem /usr/include/opencv4 t.cpp -o t -lopencv_stitching -lopencv_calib3d -lopencv_core >cc.log 2>&1 ||
  { grep -m3 -E 'error|undefined' cc.log; echo "cannot be compiled: not looked at"; exit 2; }
./t || { echo "the behaviour has changed"; exit 1; }
echo "as described: the transposed factor"
