#!/usr/bin/env bash
# cv::setRNGSeed does not reach OpenCV's RANSAC; the order of the points does
#
# One would swear: RANSAC draws from OpenCV's random numbers, so setRNGSeed(1..20)
#   gives twenty draws, and their spread says how far an estimate hangs on luck.
# What happens: findHomography, findFundamentalMat, findEssentialMat,
#   estimateAffine2D and estimateAffine3D, and the USAC ones, make a generator of
#   their own with a fixed seed at every call: twenty seeds, one answer to the
#   last bit. (kmeans does hear the seed.) The same points in another
#   order give another answer, nearly each time. The draw is still there; it is
#   only tied to the order.
# What follows: "no spread over seeds" proves nothing about an OpenCV front end; a
#   debugger that measures the luck in a pose must shuffle the matches, or draw
#   by itself with a seed that is shown. Two builds that sort keypoints
#   otherwise differ as if by another seed.
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
echo "expected: twenty seeds give several answers"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import numpy as np

rng = np.random.default_rng(0)
p = rng.uniform(0, 600, (300, 2))
H = np.array([[1.1, 0.02, 3], [0.01, 0.95, 5], [1e-4, 2e-5, 1]])
q = cv2.perspectiveTransform(p[None], H)[0] + rng.normal(0, 1, p.shape)
q[::2] += rng.uniform(-100, 100, (150, 2))
p3 = np.c_[p, p[:, 0] * p[:, 1] / 100]
q3 = np.c_[q, p3[:, 2]]
order = [rng.permutation(300) for _ in range(20)]

ways = {
    "findHomography": lambda o: cv2.findHomography(p[o], q[o], cv2.RANSAC, 3.0)[0],
    "findHomography, USAC": lambda o: cv2.findHomography(p[o], q[o], cv2.USAC_DEFAULT, 3.0)[0],
    "findFundamentalMat": lambda o: cv2.findFundamentalMat(p[o], q[o], cv2.FM_RANSAC, 3.0, 0.99)[0],
    "findEssentialMat": lambda o: cv2.findEssentialMat(p[o], q[o], 500.0, (300.0, 300.0), cv2.RANSAC, 0.99, 1.0)[0],
    "estimateAffine2D": lambda o: cv2.estimateAffine2D(p[o], q[o])[0],
    "estimateAffine3D": lambda o: cv2.estimateAffine3D(p3[o], q3[o])[1],
    "kmeans": lambda o: cv2.kmeans(np.float32(p[o]), 5, None, (3, 20, 1e-4), 1, cv2.KMEANS_RANDOM_CENTERS)[2],
}


def different(answers):
    """How many answers differ by more than a part in 10 000 (so not by rounding)."""
    kept = []
    for a in answers:
        a = a[np.lexsort(a.T)] if a.shape == (5, 2) else a / np.linalg.norm(a) * np.sign(a.flat[np.abs(a).argmax()])
        if all(np.abs(a - b).max() > 1e-4 * np.abs(b).max() for b in kept):
            kept.append(a)
    return len(kept)


ok = True
for name, way in ways.items():
    seeds = []
    for s in range(20):
        cv2.setRNGSeed(s)
        seeds.append(way(np.arange(300)))
    equal = len({a.tobytes() for a in seeds}) == 1
    n_orders = different([way(o) for o in order])
    print(f"seen: {name}: {'one answer, to the bit,' if equal else f'{different(seeds)} answers'} for 20 seeds, "
          f"{n_orders} for 20 orders of the points")
    ok = ok and (different(seeds) > 2 if name == "kmeans" else equal and n_orders > 2)
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
