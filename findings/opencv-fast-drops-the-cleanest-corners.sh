#!/usr/bin/env bash
# cv::FAST finds no corner at all where corners are perfect
#
# One would swear: the stronger a corner the surer it is found; suppression of non-maxima
#   leaves of each group of neighbours the best one, and of equal ones some one of them.
# What happens: a pixel is kept only if it is better than all eight neighbours, so that equal
#   ones put each other out. The score is a difference of grey values, and around a clean
#   corner between two flat greys several pixels have the same: of 35 squares, upright or
#   turned, 840 pixels are corners before suppression and none after, at any contrast. One grey
#   level of noise, or a blur of half a pixel, brings nearly all of them back. AGAST, the same
#   test in the same library, keeps one for each corner. cv::ORB, which takes its points from
#   FAST, has none in its finest octave and hundreds in the coarser ones.
# What follows: rendered sequences without noise, drawings and masks are no test for what
#   uses FAST; they look like a defect of it. Give them a sensor's noise first. A count of
#   keypoints that is 0 in octave 0 alone is a sign of it. An own suppression should let one
#   of equals win (>= on one side, > on the other).
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
echo "expected: some 140 corners of 35 squares, with suppression or without"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np


def squares(dark, bright, degrees=0, noise=0.0):
    picture = np.full((240, 320), dark, np.float32)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    corners = np.array([[-10, -10], [10, -10], [10, 10], [-10, 10]]) @ np.array([[c, s], [-s, c]])
    for y in range(30, 220, 42):
        for x in range(30, 300, 42):
            cv2.fillConvexPoly(picture, np.rint(corners + (x, y)).astype(np.int32), bright)
    return np.clip(picture + noise * np.random.default_rng(1).normal(size=picture.shape), 0, 255).astype(np.uint8)


def count(picture):
    fast = [len(cv2.FastFeatureDetector_create(20, suppress).detect(picture)) for suppress in (False, True)]
    agast = len(cv2.AgastFeatureDetector_create(20, True).detect(picture))
    octaves = np.bincount([p.octave for p in cv2.ORB_create(2000, edgeThreshold=15).detect(picture)], minlength=8)
    return *fast, agast, int(octaves[0]), int(octaves[1:].sum())


ok = True
for name, picture in (("black and white", squares(0, 255)), ("greys 100 and 140", squares(100, 140)),
                      ("turned by 20 degrees", squares(0, 255, 20))):
    pixels, kept, agast, finest, coarser = count(picture)
    print(f"seen, {name}: FAST {pixels} pixels, {kept} after suppression; AGAST {agast}; "
          f"ORB {finest} in octave 0, {coarser} in the others")
    ok = ok and pixels >= 800 and kept == 0 and agast == 140 and finest == 0 and coarser > 300
noisy = count(squares(60, 200, 0, 1.0))
print(f"seen, one grey level of noise: FAST {noisy[0]} pixels, {noisy[1]} after suppression")
sys.exit(0 if ok and 110 <= noisy[1] <= 150 else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "changed: equal neighbours do not put each other out"; exit 1; }
echo "as described: perfect corners put each other out"
