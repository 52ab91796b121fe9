#!/usr/bin/env bash
# Assimp widens a glTF camera by multiplying its angle: f of 525 pixels comes out as 497
#
# One would swear: a camera with a vertical field of view and the ratio of its sides has one
#   horizontal field of view, 2 atan(ratio tan(v / 2)), and a converter between formats that store one
#   or the other uses it.
# What happens: reading glTF, Assimp multiplies the angle itself by the ratio. A camera of 640 x 480
#   pixels with f = 525 leaves as COLLADA with 65.5 degrees where 62.7 were right, f = 497; one of 752
#   x 480 with f = 300 has 121 degrees for 103 and f = 212. With square pictures it is right, with
#   narrow lenses nearly: f = 2000 loses 0.4 %. Height and ratio, written down beside it, look right.
#   COLLADA to COLLADA keeps the angle.
# What follows: a simulated data set whose scene went through Assimp (many viewers and engines read
#   with it) has other intrinsics than its modeller says, by 5 % for a Kinect: compute f from yfov in
#   the glTF, or from the matrix that renders, never from mHorizontalFOV. A scale between rendered and
#   true motion that differs between the middle and the margin is this.
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
want assimp-utils 5.2.5
want python3 3.11
echo "expected: the focal length that was put in"
cat >"$tmp/t.py" <<'PY'
import base64
import json
import math
import re
import struct
import subprocess
import sys


# A glTF scene of one triangle and one camera of the given size and focal length in pixels.
def scene(width, height, focal):
    corners = struct.pack("<9f", 0, 0, -2, 1, 0, -2, 0, 1, -2)
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
            "nodes": [{"name": "eye", "camera": 0}, {"name": "thing", "mesh": 0}],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 2 * math.atan(height / 2 / focal),
                                                                "aspectRatio": width / height, "znear": 0.1, "zfar": 50}}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                           "min": [0, 0, -2], "max": [1, 1, -2]}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + base64.b64encode(corners).decode()}]}


def convert(source, target):
    subprocess.run(["assimp", "export", source, target], check=True, capture_output=True)
    with open(target) as file:
        text = file.read()
    return float(re.search(r"<xfov[^>]*>([\d.]+)", text)[1]), float(re.search(r"<aspect_ratio>([\d.]+)", text)[1])


ok = True
cases = ((640, 480, 525, 490, 505), (752, 480, 300, 205, 220), (640, 480, 2000, 1985, 1996), (480, 480, 300, 299.9, 300.1))
for width, height, focal, low, high in cases:
    with open("scene.gltf", "w") as file:
        json.dump(scene(width, height, focal), file)
    angle, ratio = convert("scene.gltf", "scene.dae")
    again, _ = convert("scene.dae", "again.dae")
    right = math.degrees(2 * math.atan(width / 2 / focal))
    multiplied = math.degrees(2 * math.atan(height / 2 / focal)) * width / height
    came = width / 2 / math.tan(math.radians(angle) / 2)
    print(f"seen, {width} x {height}, f = {focal}: {angle:.2f} degrees where {right:.2f} are right, f = {came:.1f}; "
          f"the ratio is {ratio:.4f}; the vertical angle times the ratio {multiplied:.2f}; COLLADA read and written again {again:.2f}")
    ok = ok and low < came < high and abs(angle - multiplied) < 0.01
    ok = ok and abs(ratio - width / height) < 1e-4 and abs(again - angle) < 0.01
sys.exit(0 if ok else 1)
PY
(cd "$tmp" && nice /usr/bin/python3 t.py) || { echo "the behaviour has changed"; exit 1; }
echo "as described: the angle is multiplied, not its tangent"
