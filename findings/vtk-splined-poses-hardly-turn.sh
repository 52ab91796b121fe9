#!/usr/bin/env bash
# VTK's spline through poses, its default, leaves nearly all of their rotation out
#
# One would swear: a spline through key poses goes through them; vtkTransformInterpolator,
#   which is made for playing cameras and objects along a path, gives at the time of a key
#   the pose of that key, in position and rotation.
# What happens: positions are right, but between the first key and the last, and at the keys
#   themselves, a turn of 10 degrees comes out as 0.17, one of 120 as 3.5; at the last key the
#   full rotation is there again, in one jump. vtkQuaternionInterpolator ends its spline with
#   NormalizeWithAngleInDegrees, which takes w, half an angle's cosine, for an angle and
#   multiplies it by 180/pi: with w divided by 57.3 all rotations are right. That is for three
#   keys and more; two are joined by slerp, which is right, as is type Linear for any number.
# What follows: a trajectory that is smoothed or filled up by VTK is to be interpolated by
#   Linear, or by slerp of one's own; a camera that slides along its path without turning and
#   snaps round at the end of the film has this.
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
want python3-vtk9 9.1.0
want python3-numpy 1:1.24
echo "expected: no difference at the keys, and little between them"
cat >"$tmp/t.py" <<'PY'
import sys

import numpy as np
import vtk


def key(t):  # a camera that moves along x, looks down a little and turns by 30 degrees a key
    pose = vtk.vtkTransform()
    pose.Translate(t, 0, 0)
    pose.RotateZ(30 * t)
    pose.RotateX(10)
    return pose


def matrix(pose):
    return np.array([[pose.GetMatrix().GetElement(i, j) for j in range(4)] for i in range(4)])


def apart(a, b):
    turn = a[:3, :3].T @ b[:3, :3]
    axis = [turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]
    return np.degrees(np.arctan2(np.linalg.norm(axis), np.trace(turn) - 1))


def errors(keys, linear, times):
    path, got, found = vtk.vtkTransformInterpolator(), vtk.vtkTransform(), []
    if linear:
        path.SetInterpolationTypeToLinear()
    for t in range(keys):
        path.AddTransform(t, key(t))
    for t in times:
        path.InterpolateTransform(t, got)
        found.append((apart(matrix(key(t)), matrix(got)), abs(matrix(got)[0, 3] - t)))
    return np.array(found).T


default = vtk.vtkTransformInterpolator()
is_spline = default.GetInterpolationType() == default.INTERPOLATION_TYPE_SPLINE
inner = [1, 2, 3, 4]
spline, at = errors(6, False, inner)
linear, _ = errors(6, True, inner + [0.5, 2.5])
last, two = errors(6, False, [5])[0], errors(2, False, [0.5])[0]
print(f"seen: the default is the spline: {is_spline}; keys at 30 to 120 degrees are missed by",
      ", ".join(f"{e:.1f}" for e in spline), f"degrees and by {at.max():.0e} in position")
print(f"seen: the last key, at 150 degrees, is missed by {last[0]:.0e}; half way between two keys alone: {two[0]:.0e}; "
      f"Linear, at and between keys: {linear.max():.0e} degrees")

turns, out = vtk.vtkQuaternionInterpolator(), [0.0] * 4
for t in range(6):
    turns.AddQuaternion(t, [np.cos(np.radians(5 * t)), 0, 0, np.sin(np.radians(5 * t))])
read, mended = [], []
for t in (1, 2, 2.5, 4):
    turns.InterpolateQuaternion(t, out)
    read.append(np.degrees(2 * np.arctan2(out[3], out[0])) / (10 * t))
    mended.append(np.degrees(2 * np.arctan2(out[3], np.radians(out[0]))) / (10 * t))
print("seen: of 10, 20, 25 and 40 degrees the quaternions keep", ", ".join(f"{r:.2%}" for r in read),
      "and with w divided by 57.3", ", ".join(f"{m:.2%}" for m in mended))
ok = (is_spline and np.all(spline > 0.9 * 30 * np.array(inner)) and at.max() < 1e-9 and last[0] < 1e-3 and two[0] < 1e-3
      and linear.max() < 1e-3 and max(read) < 0.03 and np.allclose(mended, 1, atol=1e-6))
sys.exit(0 if ok else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: a spline of rotations hardly turns"
