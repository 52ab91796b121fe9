#!/usr/bin/env bash
# cv::phaseCorrelate's fractions of a pixel mean little: of a quarter 0.04 is left, or 0.4
#
# One would swear: "5x5 weighted centroid around the peak to achieve subpixel accuracy" is good to
#   some hundredths of a pixel, and if not, then at least a larger shift gives a larger number.
# What happens: the peak of a fractional shift is a sinc, with side lobes below zero, and what its
#   centroid over five pixels says is nearly the whole pixel: in a sharp picture 0.1, 0.25 and 0.4
#   come out as 0.01, 0.04 and 0.12, and half a pixel as 0.2 or 0.8. Blurred by one and a half
#   pixels, when the finer frequencies hold nothing but rounding, it errs the other way, 0.4 is 0.66
#   and 0.6 is 0.34: the camera goes on and the number goes back. The response says 0.98 in the one
#   case and 1.03 in the other. Whole pixels are right to 0.01. skimage's phase_cross_correlation,
#   on the same pictures, is right to 0.03 throughout.
# What follows: the function is for the whole pixel. For more (stabilising, residual flow, testing
#   a tracker or a registration of depth with colour) fit the phases, upsample as skimage does, or
#   let Lucas-Kanade go on from there. An error curve over the shift with a period of one pixel is
#   this.
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
want python3-skimage 0.19.3
echo "expected: shifts of 0.1, 0.25, 0.4, 0.5, 0.6, 0.75 and 3 pixels come out as such"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np
from skimage.registration import phase_cross_correlation

cv2.setNumThreads(1)
width, height = 800, 640
fx, fy = np.fft.fftfreq(width)[None], np.fft.fftfreq(height)[:, None]
f = np.hypot(fx, fy)
f[0, 0] = np.inf
window = cv2.createHanningWindow((640, 480), cv2.CV_64F)
shifts = [0, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 3]


def camera(blur):  # a scene of 1/f, as pictures of the world are, of which a part moves into view
    scene = np.fft.fft2(np.random.default_rng(1).normal(size=(height, width))) / f * np.exp(-2 * (np.pi * blur * f) ** 2)
    scene[f == np.inf] = 0
    at = lambda d: np.fft.ifft2(scene * np.exp(-2j * np.pi * fx * d)).real[80:560, 80:720]
    scale = 40 / at(0).std()
    return lambda d: np.clip(np.round(128 + scale * at(d)), 0, 255)


found, response, other = {}, {}, {}
for blur in (0.7, 1.5):
    picture = camera(blur)
    seen = [cv2.phaseCorrelate(picture(0), picture(d), window) for d in shifts]
    found[blur] = np.array([s[0][0] for s in seen])
    response[blur] = np.mean([s[1] for s in seen[1:-1]])
    flat = lambda d: (picture(d) - 128) * window
    other[blur] = np.array([-phase_cross_correlation(flat(0), flat(d), upsample_factor=50)[0][1] for d in shifts])
    print(f"seen, blurred by {blur} px: ", ", ".join(f"{d:g}: {s:.2f}" for d, s in zip(shifts, found[blur])),
          f"(response {response[blur]:.2f}); skimage off by up to {np.abs(other[blur] - shifts).max():.2f}")
sharp, soft = found[0.7], found[1.5]
whole = all(abs(s[i] - shifts[i]) < 0.02 for s in (sharp, soft) for i in (0, 7))
ok = whole and sharp[2] < 0.1 and sharp[3] < 0.2 and min(abs(sharp[4] - 0.2), abs(sharp[4] - 0.8)) < 0.1 and sharp[5] > 0.8
ok = ok and soft[2] > 0.35 and soft[3] > 0.55 and soft[5] < 0.45 and all(r > 0.9 for r in response.values())
ok = ok and all(np.abs(o - shifts).max() < 0.06 for o in other.values())
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: only whole pixels are to be believed"
