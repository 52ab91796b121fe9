#!/usr/bin/env bash
# OpenCV's MSLIC makes twenty times the superpixels that it is asked for, by noise and by iterations
#
# One would swear: createSuperpixelSLIC with region_size 20 makes some 640 x 480 / 400 = 768
#   superpixels with any of its three algorithms; MSLIC moves them to where the content is, more
#   iterations make them settle, and noise of a few grey levels makes edges a little ragged.
# What happens: that is so for SLIC and SLICO. MSLIC splits what spreads in colour, and noise spreads:
#   of one picture it makes 685 without noise, 2100 with a noise of 2 grey levels of 255, 10000 and
#   more with 4, and 15000 of 20 pixels each with 6. It does not settle either: with 4 grey levels
#   there are 660 after two iterations, 2500 after three, 4200 after five, 10500 after ten and 17000
#   after twenty. enforceLabelConnectivity takes less than a tenth away. With a 3 x 3 blur before, as
#   the page recommends, noise of 6 still doubles them.
# What follows: for superpixels that are compared from frame to frame, or whose number is a parameter of
#   a method, MSLIC is not the third choice beside the others: pictures with more noise are cut finer.
#   getNumberOfSuperpixels() is to be written down with the results.
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
want python3-numpy 1:1.24
echo "expected: some 768 superpixels, whatever the noise"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

cv2.setNumThreads(1)
X = cv2.ximgproc
yy, xx = np.mgrid[0:480, 0:640].astype(float)


def picture(noise):  # soft waves, thirty coloured rectangles, and noise
    rng = np.random.default_rng(3)
    out = np.zeros((480, 640, 3))
    for c in range(3):
        out[..., c] = 128 + 20 * sum(np.sin(0.008 * np.pi * k * (np.cos(k + c) * xx + np.sin(k + c) * yy)) for k in range(1, 5))
    for _ in range(30):
        p = rng.integers(0, [640, 480])
        q = p + rng.integers(20, 120, 2)
        out[p[1]:q[1], p[0]:q[0]] = rng.integers(0, 255, 3)
    return np.clip(np.round(out + noise * rng.normal(size=out.shape)), 0, 255).astype(np.uint8)


def count(noise, algorithm, iterations=10, blur=False):
    bgr = picture(noise)
    lab = cv2.cvtColor(cv2.GaussianBlur(bgr, (3, 3), 0) if blur else bgr, cv2.COLOR_BGR2LAB)
    s = X.createSuperpixelSLIC(lab, algorithm, 20, 10.0)
    s.iterate(iterations)
    found = s.getNumberOfSuperpixels()
    s.enforceLabelConnectivity(25)
    return found, s.getNumberOfSuperpixels()


ok = True
for name in ("SLIC", "SLICO", "MSLIC"):
    by_noise = {noise: count(noise, getattr(X, name)) for noise in (0, 2, 4, 6)}
    by_iterations = {i: count(4, getattr(X, name), i)[0] for i in (1, 2, 3, 5, 20)}
    blurred = count(6, getattr(X, name), blur=True)
    print(f"seen: {name}: superpixels (and after enforceLabelConnectivity) with a noise of", ", ".join(f"{k}: {a} ({b})" for k, (a, b) in by_noise.items()))
    print(f"seen: {name}, noise of 4, after iterations", ", ".join(f"{k}: {v}" for k, v in by_iterations.items()),
          f"; noise of 6 and a 3 x 3 blur: {blurred[0]} ({blurred[1]})")
    if name == "MSLIC":
        ok = ok and 600 < by_noise[0][0] < 800 and by_noise[2][1] > 1500 and by_noise[4][1] > 6000 and by_noise[6][1] > 10000
        ok = ok and 600 < by_iterations[2] < 800 and by_iterations[3] > 2000 and by_iterations[20] > 12000 and blurred[1] > 1300
    else:
        ok = ok and all(700 < n < 800 for n in [*by_iterations.values(), *blurred, *(n for both in by_noise.values() for n in both)])
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: noise and iterations decide how many"
