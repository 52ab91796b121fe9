#!/usr/bin/env bash
# AprilTag and OpenCV disagree on the same tag by half a pixel and half a turn
#
# One would swear: two detectors of tag36h11 in one picture agree on corners to
#   some hundredths of a pixel, and on which corner is the first; and OpenCV's
#   CORNER_REFINE_APRILTAG is its AprilTag code fitted to OpenCV's pixels.
# What happens: in AprilTag a pixel's centre is at 0.5, in OpenCV at 0: all four
#   corners, and the centre, lie half a pixel right and down. CORNER_REFINE_APRILTAG
#   brings that shift into OpenCV itself: the same function gives corners half
#   a pixel apart by a flag, and SUBPIX is the one without it. And
#   the marker that OpenCV draws for a tag is upside down to AprilTag: what
#   OpenCV returns as the upper left corner, AprilTag calls right bottom.
# What follows: poses from tags (as truth, or for hand-eye) must say the detector.
#   A truth from AprilTag used with intrinsics from OpenCV is off by half
#   a pixel over the focal length (1 mm at 1 m with f = 500), and turned by 180 degrees
#   about the tag's normal. A debugger that gets pixels from others must ask
#   whether the first pixel's centre is 0 or 0.5.
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
want python3-apriltag 3.3.0
echo "expected: offsets within 0.1 px of the true corners, the same corner first"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import numpy as np
import apriltag

tags = cv2.aruco.Dictionary_get(cv2.aruco.DICT_APRILTAG_36h11)
cells = cv2.aruco.drawMarker(tags, 5, 8)
H = np.array([[28.3, 3.1, 180.37], [-2.7, 27.1, 120.61], [0.004, 0.003, 1]])
inverse, fine = np.linalg.inv(H), 8
picture = np.zeros((480, 640))
for dy in range(fine):  # the mean over each pixel's square, whose middle is the whole number
    for dx in range(fine):
        y, x = np.mgrid[0:480, 0:640] + 0.0
        x, y = x + (dx + 0.5) / fine - 0.5, y + (dy + 0.5) / fine - 0.5
        u, v, w = (r[0] * x + r[1] * y + r[2] for r in inverse)
        i, j = np.floor(u / w).astype(int), np.floor(v / w).astype(int)
        inside = (i >= 0) & (j >= 0) & (i < 8) & (j < 8)
        picture += np.where(inside & (cells[j.clip(0, 7), i.clip(0, 7)] < 128), 40, 200)
picture = (picture / fine**2).round().astype(np.uint8)
true = cv2.perspectiveTransform(np.array([[[0, 0], [8, 0], [8, 8], [0, 8.0]]]), H)[0]

mean = {}
for name in ("SUBPIX", "APRILTAG"):
    how = cv2.aruco.DetectorParameters_create()
    how.cornerRefinementMethod = getattr(cv2.aruco, "CORNER_REFINE_" + name)
    corners, ids, _ = cv2.aruco.detectMarkers(picture, tags, parameters=how)
    mean[name] = (corners[0][0] - true).mean(0)
    print(f"seen: OpenCV, CORNER_REFINE_{name}: id {ids[0][0]}, corners off by {mean[name].round(3)} px in the mean")
found = apriltag.apriltag("tag36h11").detect(picture)[0]
theirs = np.array(found["lb-rb-rt-lt"])
nearest = [int(np.argmin(np.linalg.norm(true - c, axis=1))) for c in theirs]
mean["lib"] = (theirs - true[nearest]).mean(0)
names = ["left bottom", "right bottom", "right top", "left top"]
first = names[nearest.index(0)]
print(f"seen: AprilTag: id {found['id']}, corners off by {mean['lib'].round(3)} px in the mean")
print(f"seen: OpenCV's first corner (upper left) is AprilTag's {first}")
ok = (np.abs(mean["SUBPIX"]).max() < 0.1 and np.abs(mean["APRILTAG"] - 0.5).max() < 0.1
      and np.abs(mean["lib"] - 0.5).max() < 0.1 and first == "right bottom")
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
