#!/usr/bin/env bash
# cv::recoverPose counts no point farther than 50 baselines, and then guesses
#
# One would swear: with perfect matches and the right essential matrix,
#   recoverPose picks the one of four poses that has the points in front of
#   both cameras, however far they are.
# What happens: the usual overloads carry a hidden limit: a point deeper than
#   50 times the baseline counts as wrong in all four poses. If the whole scene
#   lies beyond, the counts are 0, 0, 0, 0 and the first pose of the list is
#   returned, in about half of the motions with the rotation half a turn off.
#   No error, and the mask is all zero.
# What follows: at 30 frames a second and 0.3 m/s the baseline is 1 cm, so
#   the limit is half a metre: neighbouring frames of an indoor film are
#   beyond it. A debugger must treat a count of 0 as "no pose", must not
#   compare its own relative pose with recoverPose's default, and, where it
#   calls it, must pass distanceThresh itself.
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
want python3-opencv 4.6.0
echo "expected: all 200 perfect points are counted at any distance, and the rotation is right"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import numpy as np

K = np.array([[500, 0, 320], [0, 500, 240], [0, 0, 1.0]])
rng = np.random.default_rng(7)


def pixels(X):
    x = X @ K.T
    return x[:, :2] / x[:, 2:]


def one(depth, limit=None):
    """Points at `depth` baselines; returns the count and the rotation's error in degrees."""
    X = np.c_[rng.uniform(-0.5, 0.5, 200), rng.uniform(-0.4, 0.4, 200), np.ones(200)] * depth
    R = cv2.Rodrigues(rng.uniform(-0.03, 0.03, 3))[0]
    t = rng.normal(size=3)
    t /= np.linalg.norm(t)
    E = np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]]) @ R
    a, b = pixels(X), pixels(X @ R.T + t)
    if limit is None:
        n, Rr, _, _ = cv2.recoverPose(E, a, b, K)
    else:
        n, Rr = cv2.recoverPose(E, a, b, K, distanceThresh=limit)[:2]
    cosine = (np.trace(Rr @ R.T) - 1) / 2
    return n, np.degrees(np.arccos(np.clip(cosine, -1, 1)))


near = [one(45) for _ in range(40)]
far = [one(60) for _ in range(40)]
told = [one(60, 1000.0) for _ in range(40)]
wrong = sum(e > 150 for _, e in far)
print(f"seen: at 45 baselines {min(n for n, _ in near)} to {max(n for n, _ in near)} points counted, "
      f"largest rotation error {max(e for _, e in near):.3f} degrees")
print(f"seen: at 60 baselines {min(n for n, _ in far)} to {max(n for n, _ in far)} points counted, "
      f"rotation half a turn off in {wrong} of 40 motions")
print(f"seen: at 60 baselines with distanceThresh 1000: {min(n for n, _ in told)} points counted, "
      f"largest rotation error {max(e for _, e in told):.3f} degrees")
ok = (all(n == 200 and e < 0.01 for n, e in near) and all(n == 0 for n, _ in far)
      and 5 <= wrong <= 35 and all(n == 200 and e < 0.01 for n, e in told))
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
