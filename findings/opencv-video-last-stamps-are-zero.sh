#!/usr/bin/env bash
# OpenCV stamps the last frames of an H.264 video with 0 ms
#
# One would swear: after each read(), CAP_PROP_POS_MSEC is the time of the frame
#   that was read; it grows from frame to frame to the end of the film.
# What happens: frames are right, and all of them come, but those that the
#   decoder still holds when the file has ended (as many as it may reorder: two
#   with x264's and x265's defaults) are stamped 0. The same film encoded
#   without B frames, or as MPEG-4, is stamped to its end.
# What follows: a list of stamps from OpenCV steps back at its end. Sorted by
#   time, the film's last frames become its first; an odometry that asks for
#   growing stamps drops them, or sees a step of minus a whole film. Stamps that
#   fall back at the end are to be continued by the last step, or read by ffprobe.
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
film() { # name, encoder and its options: 25 frames of 40 ms
  local name=$1
  shift
  ffmpeg -v error -y -f lavfi -i testsrc=size=320x240:rate=25:duration=1 -pix_fmt yuv420p "$@" "$tmp/$name" ||
    { echo "ffmpeg could not make $name: not looked at"; exit 2; }
}
film reordered.mp4 -c:v libx264
film reordered.mkv -c:v libx264
film in_order.mp4 -c:v libx264 -bf 0
film mpeg4.mp4 -c:v mpeg4
echo "expected: 0, 40, 80, ... 960 ms of each"
cat >"$tmp/t.py" <<'PY'
import sys
import cv2

def stamps(path):
    video, seen = cv2.VideoCapture(path, cv2.CAP_FFMPEG), []
    while video.read()[0]:
        seen.append(video.get(cv2.CAP_PROP_POS_MSEC))
    return seen

growing = [40.0 * i for i in range(25)]
ok = True
for name, last in (("reordered.mp4", 2), ("reordered.mkv", 2), ("in_order.mp4", 0), ("mpeg4.mp4", 0)):
    seen = stamps(f"{sys.argv[1]}/{name}")
    print(f"seen: {name}: {len(seen)} frames, the last five at {seen[-5:]} ms")
    ok = ok and seen == growing[: 25 - last] + [0.0] * last
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" "$tmp" || { echo "changed: the stamps are not those described"; exit 1; }
echo "as described: frames that come after the file's end are stamped 0"
