#!/usr/bin/env bash
# GStreamer's JPEGs of a camera's YUY2 are pale: black is 16, white is 235, red is (238, 14, 14)
#
# One would swear: jpegenc takes YUY2 and I420, whose luma goes from 16 to 235 unless their caps say
#   otherwise, and makes a JPEG, whose luma by the format goes from 0 to 255; so it converts, or has it
#   converted.
# What happens: the planes go into the JPEG as they are. Every reader takes them for full range: black
#   is 16, white 235, contrast is down by a seventh and so is colour. GStreamer's own jpegdec, too,
#   reads them as full. Asking videoconvert for I420 with colorimetry=1:4:0:0 in between changes what
#   the caps say and no pixel. From RGB the same encoder is right, and the camera's picture by way of
#   RGB is within 2 levels. videotestsrc ! jpegenc is pale as well: what the encoder gets is
#   negotiation's choice.
# What follows: put videoconvert ! video/x-raw,format=RGB before jpegenc. Recordings of one camera as
#   JPEG by GStreamer and as PNG differ by a line of slope 0.86: thresholds on grey differences,
#   photometric errors and vignette calibrations do not carry over. A JPEG folder in which nothing is
#   darker than 16 or brighter than 235 was written so, and can be stretched back.
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
want gstreamer1.0-tools 1.22.0
want gstreamer1.0-plugins-base 1.22.0
want gstreamer1.0-plugins-good 1.22.0
want python3-pil 9.4.0
want python3-numpy 1:1.24
echo "expected: black 0, white 255, red (255, 0, 0), whatever the encoder is given"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys

import numpy as np
from PIL import Image

side = 64
rgb = {"black": (0, 0, 0), "white": (255, 255, 255), "grey": (128, 128, 128), "red": (255, 0, 0)}


# A picture of one colour as a camera's YUY2: BT.601, 16 to 235.
def yuy2(colour):
    r, g, b = (c / 255 for c in colour)
    y = 0.299 * r + 0.587 * g + 0.114 * b
    whole = [round(v) for v in (16 + 219 * y, 128 + 224 * (b - y) / 1.772, 128 + 224 * (r - y) / 1.402)]
    return np.tile(np.array([whole[0], whole[1], whole[0], whole[2]], np.uint8), side * side // 2).tobytes()


def run(pipeline):
    subprocess.run(["gst-launch-1.0", "-q", *pipeline.split()], check=True, capture_output=True)


def encode(data, form, steps):
    with open("in.raw", "wb") as file:
        file.write(data)
    run(f"filesrc location=in.raw blocksize={len(data)} ! rawvideoparse format={form} width={side} height={side} {steps} "
        "! jpegenc quality=100 ! filesink location=out.jpg")
    return tuple(np.array(Image.open("out.jpg").convert("RGB"))[side // 2, side // 2].tolist())


seen = {}
for name, colour in rgb.items():
    plain = np.tile(np.array(colour, np.uint8), side * side).tobytes()
    seen[name] = {"YUY2": encode(yuy2(colour), "yuy2", ""),
                  "YUY2 to RGB": encode(yuy2(colour), "yuy2", "! videoconvert ! video/x-raw,format=RGB"),
                  "YUY2 to full range": encode(yuy2(colour), "yuy2", "! videoconvert ! video/x-raw,format=I420,colorimetry=1:4:0:0"),
                  "RGB": encode(plain, "rgb", "")}
    print(f"seen, {name}:", "; ".join(f"{way} {came}" for way, came in seen[name].items()))
encode(yuy2(rgb["white"]), "yuy2", "")
run("filesrc location=out.jpg ! jpegdec ! videoconvert ! video/x-raw,format=RGB ! filesink location=back.raw")
own = int(np.fromfile("back.raw", np.uint8)[0])
run(f"videotestsrc pattern=white num-buffers=1 ! video/x-raw,width={side},height={side} ! jpegenc quality=100 "
    "! filesink location=test.jpg")
test = np.array(Image.open("test.jpg").convert("L"))[0, 0]
print(f"seen: a white YUY2's JPEG is {own} to jpegdec; videotestsrc's white is {test}")


def near(a, b, most):
    return max(abs(x - y) for x, y in zip(a, b)) <= most


ok = own == 235 and test == 235
for name, colour in rgb.items():
    pale = tuple(16 + 219 * c / 255 for c in colour)
    ok = ok and all(near(seen[name][way], pale, 8 if name == "red" else 1) for way in ("YUY2", "YUY2 to full range"))
    ok = ok and all(near(seen[name][way], colour, 2) for way in ("YUY2 to RGB", "RGB"))
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && nice /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
echo "as described: cameras come out pale"
