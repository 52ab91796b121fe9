#!/usr/bin/env bash
# cv::ORB describes other detectors' corners without orienting them
#
# One would swear: ORB is oriented BRIEF: compute() on corners of FAST or of
#   goodFeaturesToTrack finds each one's direction by the intensity centroid, as
#   detectAndCompute() does; only the corners are somebody else's.
# What happens: compute() takes KeyPoint::angle as it is, and those detectors leave
#   it at -1, "not applicable". ORB reads that as minus one degree: the bits are
#   those of 359 degrees, for every corner. Of a picture turned by 15 degrees the
#   corners find 0.75 of their partners, by 30 0.06, by 45 one in a hundred, where
#   ORB's own find all. SIFT's compute() does the same; BRISK's finds the directions
#   by itself. With the angle filled in by a few lines of intensity centroid, ORB
#   finds 0.99 of them.
# What follows: a front end of GFTT or FAST corners with ORB's bits (spread evenly,
#   masked, tracked ones) is plain BRIEF: good from frame to frame, blind when the
#   camera rolls and in closing loops. Nothing reports it. Whoever makes keypoints
#   sets their angle first; a debugger that shows keypoints draws the direction, and
#   says so when all of them have one and the same.
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
echo "expected: corners of any detector keep their partners when the picture turns; compute() fills in the angle"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2
import numpy as np

cv2.setNumThreads(1)
random = np.random.default_rng(1)
picture = np.full((480, 640), 128, np.uint8)
for _ in range(700):
    x, y = random.integers(0, 640), random.integers(0, 480)
    w, h = random.integers(4, 30, 2)
    cv2.rectangle(picture, (int(x), int(y)), (int(x + w), int(y + h)), int(random.integers(0, 255)), -1)
picture = cv2.GaussianBlur(picture, (5, 5), 1)
middle = np.zeros_like(picture)  # what stays inside however the picture is turned
cv2.circle(middle, (320, 240), 200, 255, -1)
disc = [(u, v) for u in range(-15, 16) for v in range(-15, 16) if u * u + v * v <= 225]


def moved(k, at, angle):
    return cv2.KeyPoint(float(at[0]), float(at[1]), k.size, angle, k.response, k.octave, k.class_id)


def centroid_angle(image, k):
    x, y = round(k.pt[0]), round(k.pt[1])
    m10 = sum(u * int(image[y + v, x + u]) for u, v in disc)
    m01 = sum(v * int(image[y + v, x + u]) for u, v in disc)
    return float(np.degrees(np.arctan2(m01, m10)) % 360)


# own: the directions of the first picture, turned along; filled: found in each picture.
def share(extractor, corners, degrees, own=False, filled=False):
    """The share of corners whose nearest description in the turned picture is their own."""
    turn = cv2.getRotationMatrix2D((319.5, 239.5), degrees, 1)
    turned = cv2.warpAffine(picture, turn, (640, 480), borderValue=128)
    here = [moved(k, k.pt, k.angle) for k in corners]
    there = [moved(k, turn @ np.array([*k.pt, 1]), (k.angle - degrees) % 360 if own else -1) for k in corners]
    for i in range(len(corners)):
        here[i].class_id = there[i].class_id = i
    if filled:
        for image, keypoints in ((picture, here), (turned, there)):
            for k in keypoints:
                k.angle = centroid_angle(image, k)
    here, a = extractor.compute(picture, here)
    there, b = extractor.compute(turned, there)
    matches = cv2.BFMatcher(cv2.NORM_L2 if a.dtype == np.float32 else cv2.NORM_HAMMING).match(a, b)
    return sum(here[m.queryIdx].class_id == there[m.trainIdx].class_id for m in matches) / len(matches)


orb, sift, brisk = cv2.ORB_create(500, nlevels=1), cv2.SIFT_create(), cv2.BRISK_create()
owns = orb.detect(picture, middle)
gftt = list(cv2.GFTTDetector_create(500, 0.01, 5).detect(picture, middle))
fast = sorted(cv2.FastFeatureDetector_create(40).detect(picture, middle), key=lambda k: -k.response)[:500]
for k in gftt + fast:
    k.size = 12  # BRISK looks at it
after, bits = orb.compute(picture, gftt)
at359 = orb.compute(picture, [moved(k, k.pt, 359.0) for k in after])[1]
same = bool((bits == at359).all())
left = {k.angle for k in after}
print(f"seen: after compute() the angles of {len(after)} GFTT corners are {sorted(left)}; bits as at 359 degrees: {same}")
seen = {}
for degrees in (0, 15, 30, 45, 90):
    seen[degrees] = {
        "ORB's own": share(orb, owns, degrees, own=True), "GFTT + ORB": share(orb, gftt, degrees),
        "FAST + ORB": share(orb, fast, degrees), "GFTT + SIFT": share(sift, gftt, degrees),
        "GFTT + BRISK": share(brisk, gftt, degrees), "GFTT, angle filled in, + ORB": share(orb, gftt, degrees, filled=True)}
    print(f"seen: turned by {degrees}: " + ", ".join(f"{name} {value:.2f}" for name, value in seen[degrees].items()))
good, blind = ("ORB's own", "GFTT + BRISK", "GFTT, angle filled in, + ORB"), ("GFTT + ORB", "FAST + ORB", "GFTT + SIFT")
ok = (left == {-1.0} and same and all(value > 0.99 for value in seen[0].values())
      and all(seen[d][name] > 0.95 for d in (15, 30, 45, 90) for name in good)
      and all(seen[d][name] < 0.02 for d in (45, 90) for name in blind) and seen[30]["GFTT + ORB"] < 0.1)
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
