#!/usr/bin/env bash
# cv::fisheye puts what is beyond 90 degrees into the opposite corner of the picture
#
# One would swear: Kannala and Brandt's model counts angles, not tangents, and is used for lenses
#   of more than 180 degrees: a point 95 degrees off the axis towards the lower right of a
#   picture like TUM-VI's (512 x 512, 195 degrees) lands in its lower right corner.
# What happens: projectPoints divides by z first, so that an angle beyond 90 degrees becomes its
#   supplement on the other side: the point lands in the upper left, 590 pixels off and well
#   within the picture, with no word. Back, undistortPoints clips the angle on the picture at 90
#   degrees before it takes the distortion out, and gives all pixels farther out nearly one
#   and the same ray, which with these coefficients points to the upper left as well. Up to 89
#   degrees both are exact. The formula is in the documentation, where one reads it as a
#   formula; upstream has been asked to change it since 2016.
# What follows: for such lenses projection is to be written with atan2(r, z), and rays as
#   directions and not as points at z = 1; with OpenCV's functions, points must be dropped by their
#   z before projecting and pixels by their radius before undistorting. Map points that show
#   up in the corner opposite to where they left have this.
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
echo "expected: pixels to the lower right, farther out with each degree, and the same angles back"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

focal, middle = 190.0, 256.0
k = np.array([0.0034, 0.0007, -0.0020, 0.0002])
camera = np.array([[focal, 0, middle], [0, focal, middle], [0, 0, 1]])


def model(degrees):  # u and v, which are equal, of a point that far off the axis to the lower right
    theta = np.radians(degrees)
    return middle + focal * theta * (1 + k[0] * theta**2 + k[1] * theta**4 + k[2] * theta**6 + k[3] * theta**8) / np.sqrt(2)


def projected(degrees):
    theta = np.radians(degrees)
    point = np.array([[[np.sin(theta) / np.sqrt(2), np.sin(theta) / np.sqrt(2), np.cos(theta)]]])
    return float(cv2.fisheye.projectPoints(point, np.zeros(3), np.zeros(3), camera, k)[0][0, 0, 0])


def back(degrees):  # of the pixel that the lens has it on; negative to the upper left
    x, y = cv2.fisheye.undistortPoints(np.full((1, 1, 2), model(degrees)), camera, k)[0, 0]
    return float(np.degrees(np.arctan((x + y) / np.sqrt(2))))


for angle in (60, 85, 89, 91, 95, 97):
    print(f"seen, {angle} degrees to the lower right: u = v = {model(angle):.1f} by the model, {projected(angle):.1f} by projectPoints; "
          f"undistortPoints of the model's pixel: {back(angle):+.2f} degrees")
ok = all(abs(projected(a) - model(a)) < 1e-6 and abs(back(a) - a) < 1e-3 for a in (60, 85, 89))
ok = ok and all(abs(projected(a) - (2 * middle - model(180 - a))) < 1e-6 and 0 < projected(a) < 100 and model(a) < 512 for a in (91, 95, 97))
ok = ok and all(-90 < back(a) < -88.9 for a in (91, 95, 97)) and back(91) - back(97) < 0.1
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: beyond 90 degrees the lower right is the upper left"
