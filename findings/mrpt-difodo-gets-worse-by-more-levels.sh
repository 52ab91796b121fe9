#!/usr/bin/env bash
# MRPT's DIFODO gets worse by its coarse-to-fine levels: 2 mm a frame become 4 the other way
#
# One would swear: CDifodo, visual odometry from depth pictures, is a coarse-to-fine method; a second
#   and a third level let it follow faster motion, and slow motion, which one level follows, stays
#   as right as it was.
# What happens: on clean depth of a hilly wall at 2.5 m, at 80 x 60 pixels, one level has each step to
#   1 or 2 per cent, from 2 mm to 10 cm a frame, ahead, sideways and up. With two levels more (the
#   coarsest 20 x 15, as its header allows) 10 cm are right as well, but 10 mm sideways are seen as
#   15, up as 14, ahead as 12, and of 2 mm sideways nothing is left but a walk of 9 mm a frame another
#   way. The warping between the levels adds millimetres of its own: upstream's source spreads a
#   pixel onto its four neighbours by sums of squared distances, and a mean with such weights does not
#   lie where the pixel does.
# What follows: a comparison with DIFODO has to say ctf_levels, rows and cols, and to try one level as
#   well: for a camera in somebody's hand that may be the best. That more levels are safer is to be
#   tested in each method, with a camera that is slow.
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
want libmrpt-vision-dev 1:2.5.8
want libeigen3-dev 3.4.0
want g++ 4:12
echo "expected: steps seen as they are, by one level and by three"
cat >"$tmp/t.cpp" <<'CPP'
#include <cmath>
#include <cstdio>
#include <string>

#include <mrpt/vision/CDifodo.h>

struct Odometry : mrpt::vision::CDifodo {
  double x = 0, y = 0, z = 0;  // the camera's true place: ahead, to the left, up

  explicit Odometry(int levels) {
    rows = 60, cols = 80, ctf_levels = levels, cam_mode = 2, downsample = 1, m_width = 320, m_height = 240;
    fovh = 2 * std::atan(320 / 525.0), fovv = 2 * std::atan(240 / 525.0), fast_pyramid = false;
    setSpeedFilterConstWeight(0), setSpeedFilterEigWeight(0);  // each frame for itself
    const unsigned all = 2 + levels;  // from 320 to 80, and down from there
    for (auto* v : {&depth, &depth_inter, &depth_old, &depth_warped, &xx, &xx_inter, &xx_old, &xx_warped, &yy, &yy_inter, &yy_old, &yy_warped}) {
      v->resize(all);
      for (unsigned i = 0; i < all; ++i) (*v)[i].setSize(m_height >> i, m_width >> i), (*v)[i].fill(0);
    }
    transformations.resize(all);
    for (auto& m : transformations) m.resize(4, 4);
  }

  static double wall(double a, double b) { return 2.5 + 0.25 * std::sin(2.3 * a) + 0.2 * std::cos(2.9 * b) + 0.1 * std::sin(4 * a + 3 * b); }

  void loadFrame() override {  // rows from the bottom, columns from the right, as in MRPT's own programs
    depth_wf.setSize(m_height, m_width);
    for (unsigned v = 0; v < m_height; ++v)
      for (unsigned u = 0; u < m_width; ++u) {
        const double a = -(u - 159.5) / 262.5, b = -(v - 119.5) / 262.5;
        double t = 2.5;
        for (int i = 0; i < 60; ++i) t += 0.66 * (wall(y + t * a, z + t * b) - x - t);
        depth_wf(m_height - 1 - v, m_width - 1 - u) = t;
      }
  }
};

int main() {
  bool ok = true;
  const char* names[] = {"ahead", "sideways", "up"};
  for (const int levels : {1, 3})
    for (int way = 0; way < 3; ++way)
      for (const double step : {0.002, 0.01, 0.1}) {
        Odometry o(levels);
        o.loadFrame();
        o.odometryCalculation();
        o.cam_pose = o.cam_oldpose = mrpt::poses::CPose3D();
        for (int i = 0; i < 8; ++i) {
          (way == 0 ? o.x : way == 1 ? o.y : o.z) += step;
          o.loadFrame();
          o.odometryCalculation();
        }
        const double seen[] = {o.cam_pose.x(), o.cam_pose.y(), o.cam_pose.z()};
        double off = 0;
        for (int k = 0; k < 3; ++k) off += std::pow(seen[k] - (k == way ? 8 * step : 0), 2);
        off = std::sqrt(off) / (8 * step);
        std::printf("seen: %d level%s, %3.0f mm %s a frame: %.2f mm ahead, %.2f to the left, %.2f up; off by %.1f %%\n", levels, levels > 1 ? "s" : "",
                    1e3 * step, names[way], 125 * seen[0], 125 * seen[1], 125 * seen[2], 100 * off);
        ok = ok && (levels == 1 || step > 0.05 ? off < 0.03 : off > 0.1);
        if (levels == 3 && way > 0 && step < 0.05) ok = ok && (step < 0.005 ? off > 1 : off > 0.25);
      }
  return ok ? 0 : 1;
}
CPP
inc=$(printf -- '-I%s ' /usr/include/mrpt/*/include)
# shellcheck disable=SC2086
g++ -w -O2 -std=c++17 $inc -I/usr/include/eigen3 "$tmp/t.cpp" -o "$tmp/t" -lmrpt-vision -lmrpt-poses -lmrpt-math -lmrpt-core >"$tmp/cc.log" 2>&1 ||
  { grep -m3 -E 'error|undefined' "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
"$tmp/t" || { echo "the behaviour has changed"; exit 1; }
echo "as described: one level is right, three are not"
