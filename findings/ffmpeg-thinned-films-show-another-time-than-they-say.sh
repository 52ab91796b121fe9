#!/usr/bin/env bash
# FFmpeg's fps=1 shows at 0 s what was seen at 0.47 s, and -r 1 at 3 s what was seen at 1.87 or 2.37 s
#
# One would swear: ffmpeg -i film.mp4 -vf fps=10 out%04d.png, out of 30 pictures a second, takes
#   every third: 0, 3, 6, whose times are 0, 0.1, 0.2 s, and -r 10 before the output is a short form
#   of it.
# What happens: fps=10 takes 1, 4, 7: each output is the last picture whose time rounds to the
#   output's, and so half an output's period later than it says, less a picture: 33 ms at 10 Hz, 467
#   ms at 1 Hz. -r 10 as an option for the output takes 0, 1, 2, 5, 8, 11 when it writes PNG (from
#   the third on it is 133 ms behind), and 0, 1, 4, 7, 10 into a film, whose times say so: 67 ms
#   behind. At 1 Hz the PNG are 1.13 s behind and the film 0.63. In the films the stamps are 0, 0.1,
#   0.2, exactly, in all cases. Two that are right: fps=10:round=up, and select='not(mod(n,3))' with
#   -vsync 0.
# What follows: pictures that were taken out of a film by fps= or -r do not fit an IMU, ground truth
#   or another camera's by their numbers: a camera that walks at 1 m/s is a palm's width off at 10
#   Hz and a metre at 1 Hz, with a calibrated time offset that changes with the rate. Frames should
#   be taken out all, or by select.
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
want ffmpeg 7:5.1
want python3-numpy 1:1.24
want python3-pil 9.4
echo "expected: picture k at 10 Hz is picture 3 k of the film, whatever the way"
cat >"$tmp/t.py" <<'PY'
import glob
import os
import subprocess
import sys

import numpy as np
from PIL import Image

os.chdir(sys.argv[1])
film = np.repeat(np.arange(200, dtype=np.uint8), 16 * 32).tobytes()  # 200 pictures at 30 Hz that show their numbers
source = "ffmpeg -v error -y -f rawvideo -pix_fmt gray -s 32x16 -r 30 -i - "


def pictures(way):  # numbers of the pictures that become PNG
    for name in glob.glob("o*.png"):
        os.remove(name)
    subprocess.run(f"{source} {way} o%04d.png", shell=True, input=film, check=True)
    return [int(np.asarray(Image.open(name))[0, 0]) for name in sorted(glob.glob("o*.png"))]


def film_of(way):  # stamps and numbers of those of a film
    subprocess.run(f"{source} {way} -c:v ffv1 out.mkv", shell=True, input=film, check=True)
    stamps = subprocess.run("ffprobe -v error -show_entries packet=pts_time -of csv=p=0 out.mkv", shell=True, capture_output=True, text=True).stdout
    raw = subprocess.run("ffmpeg -v error -i out.mkv -vsync 0 -f rawvideo -pix_fmt gray -", shell=True, capture_output=True).stdout
    return [float(s.strip(",")) for s in stamps.split()], np.frombuffer(raw, np.uint8).reshape(-1, 512)[:, 0].tolist()


ok = True
for rate, step in ((10, 3), (1, 30)):
    right = (f"-vf fps={rate}:round=up", f"-vf \"select='not(mod(n,{step}))'\" -vsync 0")
    wrong = {f"-vf fps={rate}": (1, 1) if rate == 10 else (14, 14), f"-r {rate}": (-4, -2) if rate == 10 else (-34, -19)}  # pictures late: PNG, film
    for way in (*wrong, *right):
        png = pictures(way)
        stamps, shown = film_of(way)
        k = 4 if rate == 10 else 3
        late = (png[k] - step * k) / 30
        late_film = shown[k] / 30 - stamps[k]
        print(f"seen, {way}: PNG show {png[:6]}, picture {k} is {1000 * late:.0f} ms late; film stamped {stamps[:4]} shows {shown[:6]}, {1000 * late_film:.0f} ms late")
        due = wrong.get(way, (0, 0))
        ok = ok and abs(30 * late - due[0]) < 0.06 and abs(30 * late_film - due[1]) < 0.06
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" "$tmp" || { echo "the behaviour has changed"; exit 1; }
echo "as described: early, late or right, by the way of thinning"
