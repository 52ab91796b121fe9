#!/usr/bin/env bash
# A point cloud with float colours in its PLY is right, black, white or refused, by program
#
# One would swear: a PLY names the type of each property, so that a reader knows whether red
#   is a float of 0 to 1, a ushort of 0 to 65535 or a uchar, and scales it accordingly.
# What happens: with the same three points, three reads floats as 0 to 1; VTK and loaders.gl
#   force them into bytes unscaled, where 1.0 is 1 of 255 and everything else 0: black;
#   Draco refuses the file. Floats of 0 to 255 are right in VTK and loaders.gl,
#   and in three hundreds of thousands of times too bright. Of ushort both keep the low
#   byte: white and middle grey, 65535 and 32768, become 255 and 0. Only Draco says a word.
# What follows: colours for others are to be written as uchar, even where that costs the dark
#   levels in three (which turns them into linear light in bytes): no other type and scale
#   is read by more than two of the four. Who reads must go by the declared type, and for
#   floats may have to ask the largest value for the scale. A cloud that is black in one
#   viewer and fine in another has this.
set -u
three=0.187.0 loaders=4.4.5
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
want python3-vtk9 9.1.0
want draco 1.5.5
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "three@$three" "@loaders.gl/core@$loaders" \
  "@loaders.gl/ply@$loaders" >npm.log 2>&1 || { tail -3 npm.log; echo "three or loaders.gl cannot be had: not looked at"; exit 2; }
echo "version: three $three, loaders.gl $loaders"
echo "expected: white, middle grey (half of the range) and black from each file, by each reader"
cloud() { # file, type, scale: white, middle grey and black
  printf 'ply\nformat ascii 1.0\nelement vertex 3\n' >"$1"
  printf 'property float %s\n' x y z >>"$1"
  printf "property $2 %s\n" red green blue >>"$1"
  printf 'end_header\n0 0 1 %s %s %s\n1 0 1 %s %s %s\n2 0 1 0 0 0\n' "$3" "$3" "$3" "$4" "$4" "$4" >>"$1"
}
cloud uchar.ply uchar 255 128
cloud float1.ply float 1.0 0.5
cloud float255.ply float 255.0 128.0
cloud ushort.ply ushort 65535 32768
cat >t.mjs <<'JS'
import fs from "fs";
import { PLYLoader } from "three/examples/jsm/loaders/PLYLoader.js";
import { parse } from "@loaders.gl/core";
import { PLYLoader as LoadersPly } from "@loaders.gl/ply";

// The first channel of each point, as a share of full brightness; three's is in linear light.
const bytes = (name) => new Uint8Array(fs.readFileSync(`${name}.ply`)).buffer;
const reds = (array, full) => [0, 3, 6].map((i) => array[i] / full);
for (const name of ["uchar", "float1", "float255", "ushort"]) {
  const colour = new PLYLoader().parse(bytes(name)).getAttribute("color");
  const full = colour.array instanceof Uint8Array ? 255 : colour.array instanceof Uint16Array ? 65535 : 1;
  console.log("three", name, ...reds(colour.array, full));
  console.log("loaders.gl", name, ...reds((await parse(bytes(name), LoadersPly)).attributes.COLOR_0.value, 255));
}
JS
cat >t.py <<'PY'
import vtk

for name in ("uchar", "float1", "float255", "ushort"):
    reader = vtk.vtkPLYReader()
    reader.SetFileName(f"{name}.ply")
    reader.Update()
    colour = reader.GetOutput().GetPointData().GetScalars()
    print("VTK", name, *(colour.GetTuple3(i)[0] / 255 for i in range(3)))
PY
{ node t.mjs && /usr/bin/python3 t.py; } >seen 2>errors || { tail -3 errors; echo "a reader failed: changed"; exit 1; }
for name in uchar float1 float255 ushort; do
  draco_encoder -point_cloud -i $name.ply -o $name.drc >draco 2>&1 && echo "Draco $name 1" || echo "Draco $name refused"
done >>seen
cat >judge.py <<'PY'
import sys

seen = {}
for line in open("seen"):
    reader, name, *values = line.split()
    seen[reader, name] = [v if v == "refused" else float(v) for v in values]
for name in ("uchar", "float1", "float255", "ushort"):
    print(f"seen, white and middle grey in {name}:", "; ".join(
        f"{reader} " + ("refuses" if v[0] == "refused" else "takes it" if len(v) == 1 else f"{v[0]:.3g} and {v[1]:.3g}")
        for reader in ("three", "loaders.gl", "VTK", "Draco") for v in [seen[reader, name]]))

def near(reader, name, white, grey):
    return all(abs(a - b) <= 0.006 for a, b in zip(seen[reader, name], (white, grey, 0)))

linear = 0.214  # middle grey in linear light
ok = all(near(r, "uchar", 1, 0.5) for r in ("loaders.gl", "VTK")) and near("three", "uchar", 1, linear)
ok = ok and near("three", "float1", 1, linear) and near("three", "ushort", 1, linear) and seen["three", "float255"][0] > 255
for reader in ("loaders.gl", "VTK"):
    ok = ok and near(reader, "float1", 1 / 255, 0) and near(reader, "float255", 1, 0.5) and near(reader, "ushort", 1, 0)
ok = ok and [seen["Draco", n][0] for n in ("uchar", "float1", "float255", "ushort")] == [1, *["refused"] * 3]
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 judge.py || { echo "changed: readers agree more, or differ otherwise"; exit 1; }
echo "as described: only uchar is read by all"
