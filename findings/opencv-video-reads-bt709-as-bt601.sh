#!/usr/bin/env bash
# OpenCV reads videos tagged BT.709 as if they were BT.601
#
# One would swear: a video that says by its tags how its colours are coded
#   (BT.709, limited range, as nearly all of more than 720 lines are) is decoded
#   by what it says; red that was filmed is red that is read.
# What happens: cv::VideoCapture hands FFmpeg's scaler no matrix, and the scaler
#   takes BT.601: pure red (255, 0, 0) comes out as some (231, 0, 1), green and blue
#   off likewise. The same film coded and tagged BT.601 is read as it was.
# What follows: colours of a video read by OpenCV and of its frames read as
#   images differ by up to a tenth. Grey levels are hardly touched; what compares
#   colours is to compare frames of one kind. What players show is right: a
#   video is to be tagged, whatever OpenCV makes of it.
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
want ffmpeg 7:5.1
film() { # name, matrix as the scaler calls it, as the tag does
  ffmpeg -v error -y -f lavfi -i color=red:size=320x240:rate=25:duration=1 \
    -vf "format=gbrp,scale=out_color_matrix=$2:out_range=tv,format=yuv420p" -c:v libx264 -bf 0 -crf 5 \
    -colorspace "$3" -color_primaries bt709 -color_trc bt709 -color_range tv "$tmp/$1" ||
    { echo "ffmpeg could not make $1: not looked at"; exit 2; }
  echo "$1: $(ffprobe -v error -select_streams v -show_entries stream=color_space,color_range -of csv=p=0 "$tmp/$1")"
}
film bt709.mp4 bt709 bt709
film bt601.mp4 bt601 smpte170m
echo "expected: red, green, blue of both 255, 0, 0 to 3"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2

def colour(name):
    good, image = cv2.VideoCapture(f"{sys.argv[1]}/{name}", cv2.CAP_FFMPEG).read()
    return [round(float(value)) for value in image.mean(axis=(0, 1))][::-1] if good else None

def near(seen, wanted):
    return seen is not None and all(abs(a - b) <= 4 for a, b in zip(seen, wanted))

new, old = colour("bt709.mp4"), colour("bt601.mp4")
print(f"seen: bt709.mp4 {new}, bt601.mp4 {old}")
sys.exit(0 if near(new, [231, 0, 1]) and near(old, [255, 0, 0]) else 1)
PY
/usr/bin/python3 "$tmp/t.py" "$tmp" || { echo "changed: the colours are not those described"; exit 1; }
echo "as described: BT.709 is read as BT.601, whatever the tag says"
