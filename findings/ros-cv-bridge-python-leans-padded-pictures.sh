#!/usr/bin/env bash
# cv_bridge's Python shears pictures whose rows are padded, its C++ does not
#
# One would swear: sensor_msgs/Image has step, the length of a row in bytes, and imgmsg_to_cv2
#   goes by it; if it did not, it would say that there are more bytes than pixels.
# What happens: Python lays height x width over the bytes from the first on and never looks at
#   step. Of a picture of 638 pixels in rows of 640, as drivers with aligned buffers send it, row r
#   begins 2r pixels too late: a vertical edge leans by 63 degrees, the padding runs through as a
#   slanted seam, and the last rows are cut off. Colour pictures change their channels from row to
#   row as well, where the padding is no multiple of three. There is no error. C++ (toCvCopy), on
#   the same message, is right, and so are Python's pictures of bags that C++ nodes have written
#   again, as these come without padding.
# What follows: a reader of bags goes by step, and says so where step is more than width times the
#   pixel's size. In Python: numpy.frombuffer(data).reshape(height, step)[:, :width * size]. A
#   sequence whose pictures lean is not to be put down to the camera or its rolling shutter.
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
want python3-cv-bridge 1.16.2
want python3-sensor-msgs 1.13.1
want libcv-bridge-dev 1.16.2
want g++ 4:12
echo "expected: the same pictures with padding as without"
cat >"$tmp/t.py" <<'PY'
import sys

import numpy as np
from cv_bridge import CvBridge
from sensor_msgs.msg import Image

rng, ok = np.random.default_rng(1), True


def message(picture, encoding, padding):
    rows = picture.reshape(len(picture), -1).view(np.uint8)
    rows = np.hstack([rows, np.zeros((len(rows), padding), np.uint8)])
    return Image(height=picture.shape[0], width=picture.shape[1], encoding=encoding, step=rows.shape[1], data=rows.tobytes())


def by_step(m, dtype, channels):  # numpy alone, by the definition of step
    size = np.dtype(dtype).itemsize * channels
    rows = np.frombuffer(m.data, np.uint8).reshape(m.height, m.step)[:, : m.width * size]
    return np.ascontiguousarray(rows).view(dtype).reshape(m.height, m.width, channels).squeeze()


for encoding, dtype, channels, padding in (("mono8", np.uint8, 1, 2), ("16UC1", np.uint16, 1, 4), ("bgr8", np.uint8, 3, 2)):
    shape = (480, 638, channels) if channels > 1 else (480, 638)
    picture = rng.integers(0, 255, shape).astype(dtype)
    plain, padded = message(picture, encoding, 0), message(picture, encoding, padding)
    got = CvBridge().imgmsg_to_cv2(padded)
    rows = [r for r in range(480) if np.array_equal(got[r], picture[r])]
    start = 2 * 100  # where row 100 should begin, two pixels of padding a row
    leans = channels > 1 or np.array_equal(got[100, start:], picture[100, : 638 - start])
    print(f"seen: {encoding}, {padding} bytes of padding: {len(rows)} of 480 rows are right; "
          f"{f'row 100 begins {start} pixels late; ' if leans and channels == 1 else ''}"
          f"without padding right: {np.array_equal(CvBridge().imgmsg_to_cv2(plain), picture)}; by step: "
          f"{np.array_equal(by_step(padded, dtype, channels), picture)}")
    ok = ok and rows == [0] and leans and np.array_equal(by_step(padded, dtype, channels), picture)
    ok = ok and np.array_equal(CvBridge().imgmsg_to_cv2(plain), picture) and got.shape == picture.shape
sys.exit(0 if ok else 1)
PY
cat >"$tmp/t.cpp" <<'CPP'
#include <cv_bridge/cv_bridge.h>

#include <cstdio>

int main() {
  sensor_msgs::Image m;
  m.height = 480;
  m.width = 638;
  m.step = 2 * 640;
  m.encoding = "16UC1";
  m.data.resize(m.height * m.step);
  int wrong = 0;
  for (unsigned r = 0; r < m.height; ++r)
    for (unsigned c = 0; c < m.width; ++c) *reinterpret_cast<unsigned short*>(&m.data[r * m.step + 2 * c]) = 100 * r + c;
  const cv_bridge::CvImagePtr got = cv_bridge::toCvCopy(m);
  for (int r = 0; r < 480; ++r)
    for (int c = 0; c < 638; ++c) wrong += got->image.at<unsigned short>(r, c) != (unsigned short)(100 * r + c);
  sensor_msgs::Image again;
  got->toImageMsg(again);
  std::printf("seen: C++, 16UC1 with 4 bytes of padding: %d pixels wrong; written again, a row has %u bytes\n", wrong, again.step);
  return wrong == 0 && again.step == 2 * 638 ? 0 : 1;
}
CPP
g++ -w -std=c++17 -I/usr/include/opencv4 "$tmp/t.cpp" -o "$tmp/t" -lcv_bridge -lopencv_core -lroscpp_serialization -lrostime \
  2>"$tmp/cc.log" || { grep -m3 -E 'error|undefined' "$tmp/cc.log"; echo "cannot be compiled: not looked at"; exit 2; }
/usr/bin/python3 "$tmp/t.py" && "$tmp/t" || { echo "the behaviour has changed"; exit 1; }
echo "as described: Python's pictures lean where rows are padded"
