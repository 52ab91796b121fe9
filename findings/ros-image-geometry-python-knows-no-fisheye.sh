#!/usr/bin/env bash
# image_geometry in Python undistorts a fisheye camera as if it were not one
#
# One would swear: PinholeCameraModel.fromCameraInfo honours distortion_model, or
#   refuses the ones that it does not know, as its C++ twin from the same source
#   does (that one has equidistant).
# What happens: the Python class never looks at distortion_model. The four
#   coefficients of an equidistant camera are used as k1, k2, p1, p2: a point
#   near the corner of a 640x480 picture with f = 300 lands 123 pixels from where
#   it should be, with no word.
# What follows: rectified pictures and points in bags made by Python nodes from
#   fisheye cameras (TUM-VI and many Kalibr calibrations are equidistant) may be
#   wrong by far more than any tracker's error. A debugger must read
#   distortion_model, must refuse what it does not know, and in a bag with
#   both raw and rectified pictures should undistort the raw ones itself.
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
want python3-image-geometry 1.16.2
want libimage-geometry1d 1.16.2
want python3-opencv 4.6.0
echo "expected: the equidistant answer, or an error"
cat >"$tmp/t.py" <<'PY'
import glob
import sys
import cv2
import numpy as np
import image_geometry
from sensor_msgs.msg import CameraInfo

info = CameraInfo()
info.width, info.height, info.distortion_model = 640, 480, "equidistant"
info.D = [0.01, -0.005, 0.002, -0.0005]
info.K = [300.0, 0, 320, 0, 300, 240, 0, 0, 1]
info.R = [1.0, 0, 0, 0, 1, 0, 0, 0, 1]
info.P = [300.0, 0, 320, 0, 0, 300, 240, 0, 0, 0, 1, 0]
model = image_geometry.PinholeCameraModel()
model.fromCameraInfo(info)
seen = np.array(model.rectifyPoint((550.0, 400.0))).ravel()
K, D, point = np.array(info.K, float).reshape(3, 3), np.array(info.D), np.array([[[550.0, 400.0]]])
fisheye = cv2.fisheye.undistortPoints(point, K, D, P=K).ravel()
plain = cv2.undistortPoints(point, K, D, P=K).ravel()
info.distortion_model = "no such model"
model.fromCameraInfo(info)
nonsense = np.array(model.rectifyPoint((550.0, 400.0))).ravel()
print(f"seen: (550, 400) goes to {seen.round(1)}; equidistant would be {fisheye.round(1)}, plumb_bob {plain.round(1)}")
print(f"seen: {np.linalg.norm(seen - fisheye):.0f} pixels off; a model of an invented name gives {nonsense.round(1)}")
twin = b"equidistant" in open(glob.glob("/usr/lib/*/libimage_geometry.so*")[0], "rb").read()
print(f"seen: the C++ library knows the name equidistant: {twin}")
ok = (twin and np.linalg.norm(seen - plain) < 0.01 and 115 < np.linalg.norm(seen - fisheye) < 130
      and np.array_equal(seen, nonsense))
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
