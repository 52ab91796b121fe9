#!/usr/bin/env bash
# scikit-image's EssentialMatrixTransform fits no essential matrix: perfect matches are missed by a pixel
#
# One would swear: estimate() on perfect matches, in coordinates that the camera matrix has been
#   taken out of, gives the essential matrix to rounding: two equal singular values and a zero, and
#   no residuals.
# What happens: its two singular values differ by a per cent or two; at 500 pixels of focal length
#   perfect matches lie 0.3 pixels beside their epipolar lines in the median, 1.5 at worst, and a
#   camera that moves sideways has its rotation 0.2 degrees wrong. The eight-point method moves and
#   scales the points first; the singular values are made equal in those coordinates, and then the
#   scaling is taken back, which makes them unequal again: a matrix that fits neither the matches
#   nor a pose. Its parent, FundamentalMatrixTransform, is exact on the very same points.
#   (COLMAP had its order of these steps reported as a fault in 2020.)
# What follows: the fundamental matrix of those coordinates is to be fitted, and its singular values
#   are to be made equal afterwards. What ransac() returns, fitted to all inliers, has this error
#   too; a study of noise made with it finds a floor of a third of a pixel that no camera has.
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
want python3-skimage 0.19.3
want python3-numpy 1:1.24
echo "expected: no rotation error and no residuals, as for the fundamental matrix"
cat >"$tmp/t.py" <<'PY'
import sys

import numpy as np
from skimage.transform import EssentialMatrixTransform, FundamentalMatrixTransform


def rotation(vector):
    angle = np.linalg.norm(vector)
    x, y, z = vector / angle
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def off(a, b):
    m = a.T @ b
    axis = [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]]
    return np.degrees(np.arctan2(np.linalg.norm(axis), np.trace(m) - 1))


def look(E, a, b, R):
    """Ratio of the singular values, rotation error in degrees, median and largest Sampson distance in px."""
    U, s, V = np.linalg.svd(E)
    U, V = U * np.sign(np.linalg.det(U)), V * np.sign(np.linalg.det(V))
    W = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    turn = min(off(U @ W @ V, R), off(U @ W.T @ V, R))
    a, b = np.c_[a, np.ones(len(a))], np.c_[b, np.ones(len(b))]
    la, lb = a @ E.T, b @ E
    d = 500 * np.abs((b * la).sum(1)) / np.sqrt((la[:, :2] ** 2).sum(1) + (lb[:, :2] ** 2).sum(1))
    return s[0] / s[1], turn, np.median(d), d.max()


def equal(F):  # what the last step would have to be
    U, s, V = np.linalg.svd(F)
    return U @ np.diag([1, 1, 0]) @ V


R, ok = rotation(np.array([0.02, -0.06, 0.03])), True
for name, t in (("sideways", [0.3, 0.05, 0.1]), ("forwards", [0.02, 0.01, 0.3])):
    found = {"essential": [], "fundamental": [], "fundamental, then made equal": []}
    for seed in range(30):
        rng = np.random.default_rng(seed)
        X = np.c_[rng.uniform(-2, 2, 200), rng.uniform(-1.5, 1.5, 200), rng.uniform(3, 8, 200)]
        Y = X @ R.T + t
        a, b = X[:, :2] / X[:, 2:], Y[:, :2] / Y[:, 2:]
        E, F = EssentialMatrixTransform(), FundamentalMatrixTransform()
        ok = ok and E.estimate(a, b) and F.estimate(a, b)
        for key, matrix in zip(found, (E.params, F.params, equal(F.params))):
            found[key].append(look(matrix, a, b, R))
    for key, rows in found.items():
        ratio, turn, median, largest = np.median(rows, axis=0)
        print(f"seen, {name}, {key}: singular values 1 : {ratio:.6f}, rotation off by {turn:.1g} degrees, "
              f"distance to the epipolar lines {median:.1g} px in the median, {largest:.1g} at most")
        if key == "essential":
            ok = ok and ratio > 1.004 and median > 0.1 and largest > 0.7 and (name == "forwards" or turn > 0.1)
        else:
            ok = ok and ratio < 1 + 1e-9 and turn < 1e-6 and largest < 1e-6
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: the essential matrix of perfect matches is none"
