#!/usr/bin/env bash
# ml-matrix puts the smallest eigenvalue first, and last where a covariance has one bit out of place
#
# One would swear: an eigenvalue decomposition of a covariance has one order, whichever; the
#   normal of a patch of points is the first eigenvector, as it was in every test.
# What happens: EVD asks whether the matrix is symmetric to the last bit. If it is, values come in
#   rising order; if not, it takes the algorithm for general matrices, which does not sort. A
#   covariance of points (X^T X) is symmetric to the bit. Turned into another frame (R C R^T, as is
#   done to uncertainties and to patches of a map) 96 in 100 are not, by 1e-16, and for two of three
#   patches the first eigenvector is then not the normal, but the direction of the largest extent or
#   the other one, 90 degrees away. The decomposition as such is right to 1e-15; the README does not
#   speak of order. With { assumeSymmetric: true }, or of the mean of C and its transpose, the order
#   is rising for all.
# What follows: ask for that option, or sort by value. Normals that are right in the camera's
#   frame and lie in the surface in the world's, or change their minds as the camera turns, are
#   this.
set -u
matrix=6.15.1
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "ml-matrix@$matrix" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "ml-matrix $matrix cannot be had: not looked at"; exit 2; }
echo "version: ml-matrix $(node -p 'require("./node_modules/ml-matrix/package.json").version')"
echo "expected: one order; the first eigenvector is the patch's normal each time, or never"
cat >t.mjs <<'JS'
import { EVD, Matrix } from "ml-matrix";

let state = 1;
const random = () => (state = (state * 48271) % 2147483647) / 2147483647 - 0.5;

function rotation() {
  let q = [random(), random(), random(), random()];
  const length = Math.hypot(...q);
  const [w, x, y, z] = q.map((v) => v / length);
  return new Matrix([
    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]);
}

const degrees = (a, b) => (Math.acos(Math.min(1, Math.abs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]))) * 180) / Math.PI;
const rising = (v) => v[0] <= v[1] && v[1] <= v[2];
const count = {
  patches: 2000, asymmetric: 0, lost: 0, lostSymmetric: 0, lostPoints: 0, lostAssumed: 0, lostMean: 0, unequal: 0, wrong: 0 };
for (let i = 0; i < count.patches; i++) {
  // A patch of 60 points, 2 x 1 wide and 0.1 thick, its covariance, and the same in the world's frame.
  const points = new Matrix(60, 3).apply(function (r, c) { this.set(r, c, [2, 1, 0.1][c] * random()); });
  const local = points.transpose().mmul(points).div(60);
  const R = rotation();
  const world = R.mmul(local).mmul(R.transpose());
  const normal = R.mmul(Matrix.columnVector(new EVD(local).eigenvectorMatrix.getColumn(0))).to1DArray();
  if (!rising(new EVD(local).realEigenvalues)) count.lostPoints++;
  const evd = new EVD(world);
  const off = degrees(normal, evd.eigenvectorMatrix.getColumn(0)) > 45;
  if (off) count.lost++;
  if (off && world.isSymmetric()) count.lostSymmetric++;
  if (!world.isSymmetric()) count.asymmetric++;
  count.unequal = Math.max(count.unequal, world.clone().sub(world.transpose()).abs().max());
  const V = evd.eigenvectorMatrix, back = V.mmul(Matrix.diag(evd.realEigenvalues)).mmul(V.transpose());
  count.wrong = Math.max(count.wrong, back.sub(world).abs().max());
  if (degrees(normal, new EVD(world, { assumeSymmetric: true }).eigenvectorMatrix.getColumn(0)) > 0.01) count.lostAssumed++;
  const mean = Matrix.add(world, world.transpose()).div(2);
  if (degrees(normal, new EVD(mean).eigenvectorMatrix.getColumn(0)) > 0.01) count.lostMean++;
}
console.log(`seen: of ${count.patches} patches in their own frame ${count.lostPoints} have their values in another order than rising`);
console.log(`seen: turned, ${count.asymmetric} are not symmetric to the bit (by ${count.unequal.toExponential(0)} at most); `
  + `the first eigenvector of ${count.lost} is not the normal, ${count.lostSymmetric} of them symmetric; `
  + `all are decompositions to ${count.wrong.toExponential(0)}`);
console.log(`seen: with assumeSymmetric ${count.lostAssumed}, of the mean with the transpose ${count.lostMean}`);
process.exit(count.lostPoints === 0 && count.lost > 0.3 * count.asymmetric && count.asymmetric > 20 && count.lostSymmetric === 0
  && count.wrong < 1e-12 && count.unequal < 1e-14 && count.lostAssumed === 0 && count.lostMean === 0 ? 0 : 1);
JS
node t.mjs || { echo "the behaviour has changed"; exit 1; }
echo "as described: one bit decides which axis comes first"
