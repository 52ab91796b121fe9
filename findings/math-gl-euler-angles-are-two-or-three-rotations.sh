#!/usr/bin/env bash
# math.gl's Euler angles are two or three rotations at once: no order has matrix and quaternions agree
#
# One would swear: new Euler(a, b, c, order) is one rotation: its matrix and its quaternion turn
#   alike, a Pose made with it turns as it does, and its clone is equal to it.
# What happens: getRotationMatrix does what three does. toQuaternion and Pose.getTransformationMatrix
#   take the angles for Z Y X whatever the order is, though the pose keeps and shows it: with 10, 20
#   and 30 degrees they are 12 degrees from the matrix for X Y Z. getQuaternion, beside it, heeds the
#   order, but gives the first angle to the first axis of the order, where the matrix gives it to x:
#   right for X Y Z alone, and for the default, Z Y X, it swaps roll and yaw, 33 degrees off. With 1,
#   2 and 3 degrees the first error is 0.1 degrees, so that all looks well while the camera is held
#   level. And clone() and copy() of any Euler put true where the order was: the copy is not equal to
#   its original, and asking it for its matrix ends in "Unknown Euler angle order".
# What follows: poses for deck.gl's layers come from quaternions or matrices; where angles must be
#   read, getRotationMatrix is the one to ask. A view whose cameras lean the more they roll and pitch,
#   and stand right when level, is this.
set -u
version=4.1.0 three=0.187.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "@math.gl/core@$version" "three@$three" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "math.gl $version or three $three cannot be had: not looked at"; exit 2; }
echo "version: math.gl $(node -p 'require("./node_modules/@math.gl/core/package.json").version'), three $three"
echo "expected: 0 degrees between all of them"
cat >t.mjs <<'JS'
import { Euler, Matrix4, Pose, Quaternion } from "@math.gl/core";
import * as THREE from "three";

// The angle of what takes one rotation matrix (16 numbers) to another.
function between(a, b) {
  const of = (m) => new THREE.Quaternion().setFromRotationMatrix(new THREE.Matrix4().fromArray([...m]));
  return of(a).angleTo(of(b)) * 180 / Math.PI;
}

const turned = (q) => new Matrix4().fromQuaternion(q);
function look(order, degrees) {
  const angles = degrees.map((d) => d * Math.PI / 180);
  const euler = new Euler(...angles, Euler[order]);
  const matrix = new Matrix4();
  euler.getRotationMatrix(matrix);
  const pose = new Pose({ position: [0, 0, 0], orientation: euler });
  const three = new THREE.Matrix4().makeRotationFromEuler(new THREE.Euler(...angles, order)).elements;
  return {
    three: between(matrix, three),
    get: between(matrix, turned(euler.getQuaternion())),
    to: between(matrix, turned(euler.toQuaternion())),
    pose: between(matrix, pose.getTransformationMatrix()), kept: pose.getOrientation().order === Euler[order],
  };
}

const seen = {};
for (const [order, degrees] of [["ZYX", [10, 20, 30]], ["XYZ", [10, 20, 30]], ["YXZ", [10, 20, 30]], ["XYZ", [1, 2, 3]]]) {
  const r = seen[`${order} ${degrees}`] = look(order, degrees);
  console.log(`seen, ${order}, ${degrees} degrees: from its own matrix three's is ${r.three.toFixed(3)} degrees away, `
    + `getQuaternion ${r.get.toFixed(3)}, toQuaternion ${r.to.toFixed(3)}, the pose ${r.pose.toFixed(3)} (which kept the order: ${r.kept})`);
}
const euler = new Euler(0.1, 0.2, 0.3, Euler.XYZ), copy = euler.clone();
let said = "nothing";
try { copy.getRotationMatrix(new Matrix4()); } catch (error) { said = error.message; }
console.log(`seen: the order of a clone of XYZ (${Euler.XYZ}) is ${copy.order}; equal: ${euler.equals(copy)}; `
  + `its matrix says: ${said}`);
const within = (v, low, high) => v >= low && v < high;
// `get` and `to` are the bounds within which getQuaternion, and toQuaternion with the pose, are off.
const as = (name, get, to) => {
  const r = seen[name];
  return r.three < 1e-4 && r.kept && within(r.get, ...get) && within(r.to, ...to) && Math.abs(r.pose - r.to) < 1e-4;
};
const right = [0, 1e-4];
process.exit(as("ZYX 10,20,30", [30, 36], right) && as("XYZ 10,20,30", right, [11, 13]) && as("YXZ 10,20,30", [13, 15], [10, 13])
  && as("XYZ 1,2,3", right, [0.1, 0.15]) && copy.order === true && !euler.equals(copy) && /order/.test(said)
  && euler.equals(new Euler(0.1, 0.2, 0.3, Euler.XYZ)) ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: what angles mean depends on the method asked"
