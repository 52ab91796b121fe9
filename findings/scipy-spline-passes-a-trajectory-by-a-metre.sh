#!/usr/bin/env bash
# SciPy's spline through a trajectory goes through it in millimetres and past it in metres
#
# One would swear: splprep is splrep for curves of several coordinates: without weights, and
#   without s, it goes through the points, as splrep's page says of itself; and what a curve looks
#   like does not depend on the unit.
# What happens: splprep's s, when none is given (its page does not say what then), is m - sqrt(2
#   m) for m points, whatever the weights: squares that add up to one per point are allowed. In
#   metres that is a metre. A handheld trajectory of 20 s within a metre, 600 poses, comes out as
#   one cubic of 8 knots that misses it by 0.78 m (rms), 1.15 m at most; the same in millimetres
#   passes it by 1 mm, 6 at most. splrep, of the same numbers, coordinate by coordinate, is through
#   them all; UnivariateSpline does as splprep does. There is no warning.
# What follows: s=0 is to be written wherever a trajectory is resampled or filled up, or
#   CubicSpline used. "Smoothed" truth that has lost its loops, and an error that grew by a factor
#   when the unit changed, are this.
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
want python3-scipy 1.10.1
echo "expected: splprep at the stamps is the trajectory, in any unit"
cat >"$tmp/t.py" <<'PY'
import sys
import warnings

import numpy as np
from scipy.interpolate import UnivariateSpline, splev, splprep, splrep

warnings.simplefilter("error")  # none is expected
t = np.arange(600) / 30
path = np.c_[np.sin(t), 0.5 * np.cos(1.3 * t), 0.2 * np.sin(2 * t)]  # m


def missed(curve, points):
    d = np.linalg.norm(curve - points, axis=1)
    return np.sqrt(np.mean(d**2)), d.max()


def by_splprep(points, **more):
    spline, _ = splprep(points.T, u=t, **more)
    return missed(np.array(splev(t, spline)).T, points), len(spline[0])


(rms, most), knots = by_splprep(path)
(rms_mm, most_mm), knots_mm = by_splprep(1000 * path)
(rms_0, most_0), _ = by_splprep(path, s=0)
allowed = np.sqrt((600 - np.sqrt(1200)) / 600)
each = missed(np.stack([splev(t, splrep(t, c)) for c in path.T], 1), path)[1]
single = missed(np.stack([UnivariateSpline(t, c)(t) for c in path.T], 1), path)[0]
print(f"seen: splprep, in metres: off by {rms:.2f} m rms, {most:.2f} at most, {knots} knots; in millimetres: off by "
      f"{rms_mm:.2f} mm rms, {most_mm:.2f} at most, {knots_mm} knots; {allowed:.2f} of either unit are allowed")
print(f"seen: with s=0 off by {most_0:.0e} m, splrep of each coordinate by {each:.0e}; UnivariateSpline by {single:.2f} rms")
ok = knots == 8 and 0.7 < rms < allowed and most > 1 and knots_mm > 20 and 0.5 < rms_mm < 1.01 * allowed
ok = ok and most_0 < 1e-9 and each < 1e-9 and single > 0.7
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: without s the spline may pass by a unit of length"
