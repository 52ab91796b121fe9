#!/usr/bin/env bash
# OpenCV's l0Smooth spoils the one picture it must not change, turns small ones black and writes in its input
#
# One would swear: smoothing by L0 gradients takes texture away and keeps steps as they are, in height
#   and brightness: a picture of two flat halves is a fixed point of it, to rounding.
# What happens: of halves of 50 and 200 in 320 x 240 55 and 195 are left, in floats of 0.2 and 0.8
#   0.22 and 0.78. Small pictures lose their brightness: in 128 x 64 the mean falls from 125 to 44, in
#   80 x 60 both halves become 0; floats become negative. Pictures of one value come out right. And a
#   float picture is its own result: the input holds the output afterwards, though another was asked
#   for. The method as published, in twenty lines of numpy, keeps all of these to some
#   hundred-thousandths of the range.
# What follows: levels of a pyramid and crops are not to be given to it, and floats as copies only. A
#   comparison with and without smoothing in which both sides agree may be one with the smoothed
#   picture twice.
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
echo "expected: two halves come out as they went in, and the input is left alone"
cat >"$tmp/t.py" <<'PY'
import sys

import cv2
import numpy as np

cv2.setNumThreads(1)


def halves(height, width, low, high, kind):
    return np.ascontiguousarray(np.where(np.arange(width) < width // 2, low, high).astype(kind)[None].repeat(height, 0))


def published(picture, strength=0.02, growth=2.0):  # gradients by hard thresholds, the picture by the Fourier transform
    S = picture.astype(float)
    dx, dy = np.zeros(S.shape), np.zeros(S.shape)
    dx[0, 0], dx[0, -1], dy[0, 0], dy[-1, 0] = -1, 1, -1, 1
    dx, dy, first = np.fft.fft2(dx), np.fft.fft2(dy), np.fft.fft2(S)
    beta = 2 * strength
    while beta < 1e5:
        F = np.fft.fft2(S)
        h, v = np.fft.ifft2(dx * F).real, np.fft.ifft2(dy * F).real
        flat = h**2 + v**2 < strength / beta
        h[flat] = v[flat] = 0
        top = first + beta * (dx.conj() * np.fft.fft2(h) + dy.conj() * np.fft.fft2(v))
        S = np.fft.ifft2(top / (1 + beta * (np.abs(dx) ** 2 + np.abs(dy) ** 2))).real
        beta *= growth
    return S


ok = True
for height, width in ((240, 320), (64, 128), (60, 80)):
    for kind, low, high in ((np.uint8, 50, 200), (np.float32, 0.2, 0.8)):
        given = halves(height, width, low, high, kind)
        before = given.copy()
        out = cv2.ximgproc.l0Smooth(given)
        scale = 255 if kind is np.uint8 else 1
        right = scale * published(before / scale)
        left, other = np.median(out[:, width // 4]), np.median(out[:, 3 * width // 4])
        changed, error = not np.array_equal(given, before), np.abs(right - before).max()
        print(f"seen: {width} x {height} {kind.__name__}: {low} and {high} become {left:.3g} and {other:.3g}, the mean {before.mean():.4g} becomes "
              f"{out.mean():.4g}; the input is {'the output' if np.array_equal(given, out) else 'left alone' if not changed else 'something else'}; "
              f"the published method errs by {error:.0e}")
        ok = ok and error < 1e-4 * scale and abs((other - left) / (high - low) - 1) > 0.05
        ok = ok and changed == (kind is np.float32) and (not changed or np.array_equal(given, out))
        if height == 240:
            ok = ok and abs(out.mean() / before.mean() - 1) < 0.02
        elif kind is np.uint8:
            ok = ok and out.mean() < 0.5 * before.mean() and left == 0
for value in (0.4, 100):
    flat = np.full((60, 80), value, np.float32 if value < 1 else np.uint8)
    ok = ok and np.abs(cv2.ximgproc.l0Smooth(flat.copy()) - flat.astype(float)).max() < 1e-5
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: two halves do not survive, nor does a float input"
