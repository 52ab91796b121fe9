#!/usr/bin/env bash
# Blender reads a point cloud from PLY without its colours and writes it without its points
#
# One would swear: PLY is the format of point clouds, and a program that reads the three coloured
#   points of one shows three coloured points, and writes them back; what it cannot do it says.
# What happens: the reader keeps colours for corners of faces only, so that a cloud has its places and
#   no colour attribute at all. The writer collects the vertices that faces use: of a cloud it writes
#   a head with "element vertex 0" and no line more, ends with FINISHED, and says nothing. With one
#   face over the same three points both work, colours included; a fourth point beside the face is
#   lost. OBJ written by the same Blender has all the points.
# What follows: maps go into Blender with colours by a mesh with faces (a tiny triangle for each
#   point), and out of it by OBJ or a script; the number of points is to be compared after every such
#   step. An empty PLY that came out of Blender was a cloud.
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
want blender 3.4.1
echo "expected: as many points and colours after each step as before"
cloud() { # file, number of faces over the first three of four points
  printf 'ply\nformat ascii 1.0\nelement vertex 4\n' >"$1"
  printf 'property float %s\n' x y z >>"$1"
  printf 'property uchar %s\n' red green blue >>"$1"
  [ "$2" = 0 ] || printf 'element face %s\nproperty list uchar int vertex_indices\n' "$2" >>"$1"
  printf 'end_header\n0 0 2 255 128 0\n1 0 3 10 20 30\n0 1 3 200 0 50\n5 5 5 90 90 90\n' >>"$1"
  [ "$2" = 0 ] || printf '3 0 1 2\n' >>"$1"
}
cloud "$tmp/points.ply" 0
cloud "$tmp/faces.ply" 1
cat >"$tmp/t.py" <<'PY'
import os
import re
import sys

import bpy

folder = sys.argv[-1]


def text(name):
    with open(os.path.join(folder, name)) as file:
        return file.read()


seen = {}
for name in ("points", "faces"):
    bpy.ops.object.select_all(action="DESELECT")
    bpy.ops.import_mesh.ply(filepath=os.path.join(folder, f"{name}.ply"))
    thing = bpy.context.object
    thing.select_set(True)
    colours = sum(len(layer.data) for layer in thing.data.color_attributes)
    result = bpy.ops.export_mesh.ply(filepath=os.path.join(folder, f"{name}_out.ply"), use_ascii=True, use_selection=True)
    bpy.ops.wm.obj_export(filepath=os.path.join(folder, f"{name}_out.obj"), export_selected_objects=True)
    written = int(re.search(r"element vertex (\d+)", text(f"{name}_out.ply"))[1])
    in_obj = len(re.findall(r"^v ", text(f"{name}_out.obj"), re.M))
    lines = len(text(f"{name}_out.ply").split("end_header\n")[1].splitlines())
    seen[name] = (len(thing.data.vertices), colours, written, lines, in_obj)
    print(f"seen, four coloured points, {'one face over three' if name == 'faces' else 'no face'}: {seen[name][0]} points and {colours} "
          f"colours read; PLY: {written} points written ({'FINISHED' if result == {'FINISHED'} else result}), OBJ: {in_obj}")
print("judged:", "as described" if seen == {"points": (4, 0, 0, 0, 4), "faces": (4, 3, 3, 4, 4)} else f"changed {seen}")
PY
nice blender -b --factory-startup --python "$tmp/t.py" -- "$tmp" >"$tmp/out" 2>&1
grep '^seen' "$tmp/out"
grep -q '^judged: as described' "$tmp/out" || { tail -3 "$tmp/out"; echo "the behaviour has changed"; exit 1; }
echo "as described: no colours in, no points out"
