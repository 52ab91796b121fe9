#!/usr/bin/env bash
# three gives every COLLADA camera that states its horizontal angle 50 degrees
#
# One would swear: a COLLADA camera has xfov, yfov, or one of them and aspect_ratio, and from any of
#   these pairs a loader makes the same camera.
# What happens: ColladaLoader hands yfov and aspect_ratio to the camera and leaves xfov where it is.
#   With xfov and aspect_ratio, which is what Assimp writes, the angle is the camera class' own
#   default, 50 degrees, whatever the file says: f of 640 x 480 pictures is 515 for a lens of 300, of
#   525 and of 2000. With xfov and yfov the ratio is 1, and f in x differs from f in y. yfov and
#   aspect_ratio are right. Nothing is said. As 50 degrees are within 2 % of a Kinect's 49, the usual
#   test passes.
# What follows: frustums and views of cameras from COLLADA are to be checked against a pixel whose ray
#   is known; compute yfov = 2 atan(tan(xfov / 2) / aspect_ratio) before the file reaches the loader.
#   Two cameras of different lenses that have one frustum in a viewer, and a model that does not lie
#   on its picture, are this.
set -u
three=0.187.0 xmldom=0.9.12
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "three@$three" "@xmldom/xmldom@$xmldom" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "three $three or xmldom $xmldom cannot be had: not looked at"; exit 2; }
echo "version: three $(node -p 'require("./node_modules/three/package.json").version'), xmldom $xmldom for the page's DOM"
echo "expected: the focal lengths that were put in"
cat >t.mjs <<'JS'
import { DOMParser } from "@xmldom/xmldom";
import { ColladaLoader } from "three/examples/jsm/loaders/ColladaLoader.js";

globalThis.DOMParser = DOMParser;
const log = console.log, said = [];
console.log = console.warn = console.error = console.info = (text) => said.push(text);
const width = 640, height = 480, degrees = (side, f) => 360 / Math.PI * Math.atan(side / 2 / f);

// The focal lengths in pixels that a camera so described has in three.
function load(optics) {
  const { scene } = new ColladaLoader().parse(`<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_cameras><camera id="lens"><optics><technique_common><perspective>${optics}<znear>0.1</znear><zfar>100</zfar>
</perspective></technique_common></optics></camera></library_cameras>
<library_visual_scenes><visual_scene id="all"><node id="eye" type="NODE"><instance_camera url="#lens"/></node></visual_scene>
</library_visual_scenes>
<scene><instance_visual_scene url="#all"/></scene></COLLADA>`, "");
  let camera;
  scene.traverse((thing) => { if (thing.isCamera) camera = thing; });
  camera.updateProjectionMatrix();
  const m = camera.projectionMatrix.elements;
  return [m[0] * width / 2, m[5] * height / 2];
}

const near = (a, b) => Math.abs(a - b) < 0.01 * b, seen = {};
for (const f of [300, 525, 2000]) {
  const x = `<xfov>${degrees(width, f)}</xfov>`, y = `<yfov>${degrees(height, f)}</yfov>`;
  const ratio = `<aspect_ratio>${width / height}</aspect_ratio>`;
  // The same, with yfov worked out from xfov as it should be.
  const own = `<yfov>${360 / Math.PI * Math.atan(Math.tan(degrees(width, f) * Math.PI / 360) * height / width)}</yfov>`;
  seen[f] = { x: load(x + ratio), y: load(y + ratio), both: load(x + y), own: load(own + ratio) };
  const names = { x: "xfov and ratio", y: "yfov and ratio", both: "xfov and yfov", own: "yfov worked out from xfov" };
  for (const [key, [fx, fy]] of Object.entries(seen[f])) log(`seen, f = ${f}, ${names[key]}: ${fx.toFixed(1)} in x, ${fy.toFixed(1)} in y`);
}
const loud = said.filter((text) => !/File version/.test(text));
log(`seen: said: ${loud.length ? loud.join("; ") : "nothing"}`);
const fifty = height / 2 / Math.tan(25 * Math.PI / 180);
const ok = Object.entries(seen).every(([f, r]) => near(r.x[0], fifty) && near(r.x[1], fifty) && near(r.y[0], +f) && near(r.y[1], +f)
  && near(r.own[0], +f) && near(r.own[1], +f) && near(r.both[0], +f * width / height) && near(r.both[1], +f));
process.exit(ok && loud.length === 0 ? 0 : 1);
JS
nice node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: fifty degrees for every lens"
