#!/usr/bin/env bash
# FFmpeg's lossless H.264 of grey pictures comes back without its darkest 16 and lightest 20 levels
#
# One would swear: grey pictures piped into x264 with -qp 0, lossless, and read by the same FFmpeg are
#   the pictures that went in: grey has 0 to 255, and there is no colour to convert.
# What happens: x264 takes grey as it is, 0 to 255, and writes a stream that does not say so; H.264's
#   grey is read as yuv420p of unknown range, which is taken for 16 to 235. Everything up to 16 comes
#   back as 0, from 235 on as 255, and what is between is stretched: 220 levels, up to 20 off. No word
#   is said; the planes inside the file are right. It is so for raw pipes (NumPy, a bag, a camera),
#   PGM, raw AVI and FFV1, and not for the very same pixels as PNG, whose reader says "full".
#   -color_range pc mends it on writing; H.265 and FFV1 have a grey of their own and are right.
#   -pix_fmt yuv420p squeezes and says so: 36 levels are lost by rounding, 1 off at most.
# What follows: films of grey cameras for odometry are to be FFV1, or to carry -color_range pc.
#   Features on dark walls that are there in the PNG and gone in the film are this; a file that was
#   written so is read right with extractplanes=y, or by naming the range of the input.
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
want ffmpeg 7:5.1.9
want python3-numpy 1:1.24
echo "expected: 256 of 256 levels, 0 off"
cat >"$tmp/t.py" <<'PY'
import subprocess
import sys

import numpy as np

width, height = 256, 16
ramp = np.tile(np.arange(256, dtype=np.uint8), (height, 1))
raw = ["-f", "rawvideo", "-pix_fmt", "gray", "-s", f"{width}x{height}", "-r", "30", "-i", "-"]


def ffmpeg(*arguments, given=b""):
    return subprocess.run(["ffmpeg", "-v", "error", "-y", *arguments], input=given, capture_output=True, check=True)


def through(name, source, *encoder, film="film.mkv", reading=()):
    said = ffmpeg(*source, *encoder, film, given=ramp.tobytes() if source is raw else b"").stderr.decode().strip()
    said = "" if "x265" in said else said
    back = np.frombuffer(ffmpeg("-i", film, *reading, "-f", "rawvideo", "-pix_fmt", "gray", "-").stdout, np.uint8)[:256]
    off = np.abs(back.astype(int) - np.arange(256))
    probe = subprocess.run(["ffprobe", "-v", "error", "-show_entries", "stream=pix_fmt,color_range", "-of", "csv=p=0", film],
                           capture_output=True, text=True, check=True).stdout.strip()
    print(f"seen, {name}: read as {probe}; {len(set(back.tolist()))} of 256 levels, up to {off.max()} off; 16 is {back[16]}, "
          f"128 is {back[128]}, 235 is {back[235]}; said: {said or 'nothing'}")
    return (int(back[16]), int(back[128]), int(back[235])), int(off.max()), len(set(back.tolist()))


lossless = ("-c:v", "libx264", "-qp", "0")
ffmpeg(*raw, "-frames:v", "1", "p.pgm", given=ramp.tobytes())
ffmpeg(*raw, "-frames:v", "1", "p.png", given=ramp.tobytes())
clipped = ((0, 130, 255), 20, 220)
same = ((16, 128, 235), 0, 256)
ok = through("piped raw, x264", raw, *lossless) == clipped
ok = through("a PGM, x264", ["-i", "p.pgm"], *lossless) == clipped and ok
ok = through("a PNG, x264", ["-i", "p.png"], *lossless) == same and ok
ok = through("raw, x264 with -color_range pc", raw, *lossless, "-color_range", "pc") == same and ok
ok = through("raw, x264, read by extractplanes", raw, *lossless, reading=("-vf", "extractplanes=y")) == same and ok
ok = through("raw, x265 lossless", raw, "-c:v", "libx265", "-x265-params", "lossless=1:log-level=error") == same and ok
ok = through("raw, FFV1", raw, "-c:v", "ffv1") == same and ok
squeezed = through("raw, x264, yuv420p", raw, *lossless, "-pix_fmt", "yuv420p")
sys.exit(0 if ok and squeezed[1:] == (1, 220) else 1)
PY
(cd "$tmp" && nice /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
echo "as described: lossless by name, 36 levels short"
