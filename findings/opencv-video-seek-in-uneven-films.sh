#!/usr/bin/env bash
# cv::VideoCapture tells the right times of an uneven film and seeks by wrong ones
#
# One would swear: what POS_MSEC says after a read can be set again and leads back
#   to that frame; POS_FRAMES = n leads to the n-th frame.
# What happens: reading in order, POS_MSEC is the frame's own time, also where the
#   frame rate changes. Setting either is arithmetic with the mean rate: POS_MSEC
#   is multiplied by it to make a frame number, and the frame number is divided
#   by it to make a time. In a film of 20 frames at 30 Hz and 20 at 10 Hz,
#   POS_MSEC = 1000 gives the frame of 500 ms, POS_FRAMES = 25 gives frame 33,
#   and the last eight frames cannot be reached at all; set() says true.
# What follows: telephones and many webcams record uneven films. A debugger that
#   jumps in a film must have an index by time (or decode from a key frame and
#   read POS_MSEC after each frame), and must check after a jump where it is.
#   Frame numbers of two tools on one uneven film are comparable only when both
#   counted.
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
want ffmpeg 7:5.1.
echo "expected: 1000 ms leads to a frame at 967 or 1067 ms; frame 25 is frame 25; frame 35 is there"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys
import cv2
import numpy as np

for i in range(40):
    cv2.imwrite(f"{i:03d}.png", np.full((64, 64), 6 * i, np.uint8))
subprocess.run(["ffmpeg", "-v", "error", "-framerate", "30", "-i", "%03d.png", "-vf",
                "settb=1/30000,setpts='if(lt(N,20),N*1000,20000+(N-20)*3000)'", "-vsync", "passthrough",
                "-enc_time_base", "1/30000", "-c:v", "libx264", "-g", "1", "-qp", "0", "-pix_fmt", "yuv420p",
                "film.mp4"], check=True)
true = [i * 1000 / 30 if i < 20 else 20000 / 30 + (i - 20) * 100 for i in range(40)]


def frame(capture):
    got, picture = capture.read()
    return round(float(picture.mean()) / 6) if got else None


c = cv2.VideoCapture("film.mp4")
in_order, times = [], []
while (n := frame(c)) is not None:
    in_order.append(n)
    times.append(c.get(cv2.CAP_PROP_POS_MSEC))
print(f"seen: in order {len(in_order)} frames, times off by at most {np.abs(np.array(times) - true).max():.2f} ms")
c = cv2.VideoCapture("film.mp4")
said = c.set(cv2.CAP_PROP_POS_MSEC, 1000)
n, t = frame(c), c.get(cv2.CAP_PROP_POS_MSEC)
print(f"seen: POS_MSEC = 1000: set says {said}, then frame {n} of {t:.0f} ms")
seek = []
for i in range(40):
    c = cv2.VideoCapture("film.mp4")
    c.set(cv2.CAP_PROP_POS_FRAMES, i)
    seek.append(frame(c))
wrong = [i for i in range(40) if seek[i] is not None and seek[i] != i]
none = [i for i in range(40) if seek[i] is None]
print(f"seen: POS_FRAMES = 25 gives frame {seek[25]}; another frame for {wrong[0]} to {wrong[-1]}, none for {none[0]} to {none[-1]}")
ok = (in_order == list(range(40)) and np.abs(np.array(times) - true).max() < 1 and said and n == 15
      and abs(t - 500) < 1 and seek[:18] == list(range(18)) and seek[25] == 33
      and wrong == list(range(18, 32)) and none == list(range(32, 40)))
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
