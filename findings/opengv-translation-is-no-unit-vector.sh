#!/usr/bin/env bash
# OpenGV's relative translation is 0.7071 long, and of any length from seven points
#
# One would swear: the translation between two views of one camera, whose length cannot be seen, comes
#   as a unit vector, as from all others; or at the least always of the same length.
# What happens: relative_pose_ransac gives it with a length of 0.7071 by STEWENIUS, NISTER and
#   EIGHTPT, the half of an essential matrix of norm 1, and by SEVENPT with another each time, from
#   0.71 to some tens and more on perfect points; rotation and direction are right in all four.
#   Triangulated with it, a scene at 3 to 8 m and a baseline of one metre comes out 2.1 to 5.7 m deep,
#   or several times as large, by the method's name.
# What follows: the translation is to be normalised before it is given a length from wheels, an IMU or
#   the last pair. A scale that is too small by root two is this, and a trajectory whose scale jumps
#   from pair to pair with seven points has nothing wrong with its matches.
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
want python3-opengv 1.0+1git91f4b1
want python3-numpy 1:1.24
echo "expected: a length of 1 by all four methods"
cat >"$tmp/t.py" <<'PY'
import sys

import numpy as np
import pyopengv


def rotation(vector):
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def off(a, b):  # degrees between two directions
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


R, ok, lengths = rotation(np.array([0.05, -0.1, 0.08])), True, {}
for method in ("STEWENIUS", "NISTER", "EIGHTPT", "SEVENPT"):
    rows = []
    for seed in range(40):
        rng = np.random.default_rng(seed)
        X = np.c_[rng.uniform(-2, 2, 100), rng.uniform(-1.5, 1.5, 100), rng.uniform(3, 8, 100)]
        t = np.array([0.9, 0.3, 0.3]) / np.linalg.norm([0.9, 0.3, 0.3])
        Y = (X - t) @ R  # X = R Y + t
        a, b = (p / np.linalg.norm(p, axis=1, keepdims=True) for p in (X, Y))
        T = pyopengv.relative_pose_ransac(a, b, method, 1e-6, 500)
        depth = pyopengv.triangulation_triangulate(a, b, T[:, 3], T[:, :3])[:, 2] / X[:, 2]
        unit = pyopengv.triangulation_triangulate(a, b, T[:, 3] / np.linalg.norm(T[:, 3]), T[:, :3])[:, 2] / X[:, 2]
        turn = max(off(T[:, i], R[:, i]) for i in range(3))
        rows.append((np.linalg.norm(T[:, 3]), off(T[:, 3], t), turn, np.median(depth), np.median(unit)))
    rows = np.array(rows)
    lengths[method] = rows[:, 0]
    low, mid, high = np.percentile(rows[:, 0], [0, 50, 100])
    print(f"seen: {method}: length {low:.4f} to {high:.4f}, {mid:.4f} in the median; direction off by {np.median(rows[:, 1]):.0e} degrees, rotation "
          f"by {np.median(rows[:, 2]):.0e}; depths {np.median(rows[:, 3]):.4f} times the true ones, {np.median(rows[:, 4]):.4f} with a unit vector")
    ok = ok and np.median(rows[:, 1]) < 1e-3 and np.median(rows[:, 2]) < 1e-3 and abs(np.median(rows[:, 4]) - 1) < 1e-4
    ok = ok and np.median(np.abs(rows[:, 3] - rows[:, 0])) < 1e-4
for method in ("STEWENIUS", "NISTER", "EIGHTPT"):
    ok = ok and np.median(np.abs(lengths[method] - np.sqrt(0.5))) < 1e-8
ok = ok and lengths["SEVENPT"].max() > 1.5 * lengths["SEVENPT"].min()
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" 2>/dev/null || { echo "the behaviour has changed"; exit 1; }
echo "as described: 0.7071, and anything from seven points"
