#!/usr/bin/env bash
# mrcal's rotation vector of a half turn is zero: OpenCV's axes to OpenGL's is no rotation at all
#
# One would swear: r_from_R and rt_from_Rt are Rodrigues' formula backwards, and half turns, where
#   the formula is 0 / 0, are looked after, as in every such function; R_from_r(r_from_R(R)) is R.
# What happens: small rotations are told by a small sine, and a half turn has one too: from 0.0008
#   degrees below 180 on the vector has the length of what is missing to 180. diag(1, -1, -1), by
#   which cameras are brought from OpenCV's axes to OpenGL's, gives (0, 0, 0), as do half turns
#   about y and z and about (0.6, 0.64, 0.48), and the pose (R, t) keeps its t. 179.999 degrees are
#   right to 1e-9, and so are compose_r of two quarter turns, R_from_r and quat_from_R for the half
#   turn itself.
# What follows: poses that are made of exact turns by 180 degrees (another convention of axes, a
#   camera mounted upside down, the one that looks back in a rig) lose them on their way into rt
#   form, which is what a .cameramodel file holds. Such a matrix should be turned by compose_r from
#   two halves.
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
want python3-mrcal 2.2
want python3-numpy 1:1.24
echo "expected: vectors of length pi, and the rotation back"
cat >"$tmp/t.py" <<'PY'
import sys

import mrcal
import numpy as np

back = lambda R: np.degrees(np.arccos(np.clip((np.trace(mrcal.R_from_r(mrcal.r_from_R(R)).T @ R) - 1) / 2, -1, 1)))
ok = True
turns = {"diag(1, -1, -1)": np.diag([1.0, -1, -1]), "diag(-1, 1, -1)": np.diag([-1.0, 1, -1]), "diag(-1, -1, 1)": np.diag([-1.0, -1, 1])}
axis = np.array([0.6, 0.64, 0.48])
turns["about (0.6, 0.64, 0.48)"] = 2 * np.outer(axis, axis) - np.eye(3)
for name, R in turns.items():
    r, q = mrcal.r_from_R(R), mrcal.quat_from_R(R)
    w, v = q[0], q[1:]
    from_q = np.eye(3) + 2 * w * np.cross(np.eye(3), -v) + 2 * (np.outer(v, v) - v @ v * np.eye(3))
    print(f"seen, {name}: |r| = {np.linalg.norm(r):.2g}, {back(R):.4g} degrees away from R; the quaternion is off by {np.abs(from_q - R).max():.1g}")
    ok = ok and np.linalg.norm(r) < 1e-12 and abs(back(R) - 180) < 1e-5 and np.abs(from_q - R).max() < 1e-9
rt = mrcal.rt_from_Rt(np.vstack([np.diag([1.0, -1, -1]), [1, 2, 3]]))
print("seen, pose with diag(1, -1, -1) and t = (1, 2, 3) as rt:", rt.tolist())
ok = ok and np.abs(rt - [0, 0, 0, 1, 2, 3]).max() < 1e-12
lengths = {}
for degrees in (90, 170, 179.9, 179.999, 179.9995, 179.9999):
    lengths[degrees] = np.degrees(np.linalg.norm(mrcal.r_from_R(mrcal.R_from_r(np.radians(degrees) * axis))))
print("seen, degrees in and out:", ", ".join(f"{a} {b:.6g}" for a, b in lengths.items()))
ok = ok and all(abs(b - a) < 1e-6 for a, b in lengths.items() if a < 179.9992) and all(b < 0.001 for a, b in lengths.items() if a > 179.9992)
quarter = mrcal.compose_r(np.pi / 2 * axis, np.pi / 2 * axis)
print(f"seen, compose_r of two quarter turns: {np.degrees(np.linalg.norm(quarter)):.6f} degrees, off by "
      f"{np.abs(mrcal.R_from_r(quarter) - turns['about (0.6, 0.64, 0.48)']).max():.1g}")
sys.exit(0 if ok and np.abs(mrcal.R_from_r(quarter) - turns["about (0.6, 0.64, 0.48)"]).max() < 1e-9 else 1)
PY
/usr/bin/python3 "$tmp/t.py" || { echo "the behaviour has changed"; exit 1; }
echo "as described: a half turn is no turn"
