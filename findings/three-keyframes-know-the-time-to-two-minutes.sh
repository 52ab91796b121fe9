#!/usr/bin/env bash
# three's keyframes know the time to two minutes: a trajectory with its own stamps stands still
#
# One would swear: all numbers in JavaScript are doubles, which know today's seconds to a quarter
#   of a microsecond; KeyframeTrack takes an array of times and plays poses at them.
# What happens: it copies times into floats. Unix seconds have steps of 128 there, so that all 300
#   poses of ten seconds have one time; validate() is content, the clip plays, and the camera stands
#   at its first pose throughout. optimize() drops all but two of them for being at the same time.
#   Seconds of the GPS week have steps of a 16th on its last day: two poses each share a time, and a
#   camera that moves evenly goes in jerks, up to half a frame off. From zero all is right. A
#   Float64Array given to the constructor becomes floats as well; laid into track.times afterwards
#   it is kept, and all is right.
# What follows: a viewer takes the first stamp off in whole nanoseconds or doubles before anything
#   reaches three (glTF's animations are floats by definition, so that exporting does it again), and
#   a check of a replay asks for a pose in the middle, not whether it ran.
set -u
three=0.187.0
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
cd "$tmp" || exit 2
npm init -y >/dev/null 2>&1 && npm install --no-audit --no-fund "three@$three" >npm.log 2>&1 ||
  { tail -3 npm.log; echo "three $three cannot be had: not looked at"; exit 2; }
echo "version: three $(node -p 'require("./node_modules/three/package.json").version')"
echo "expected: 300 times; the pose of every stamp where it was"
cat >t.mjs <<'JS'
import { AnimationClip, AnimationMixer, Object3D, VectorKeyframeTrack } from "three";

// A camera that goes along x by one unit a frame, 300 frames at 30 Hz from `start`.
const frames = 300;
function play(start, kind) {
  const times = Array.from({ length: frames }, (_, i) => start + i / 30);
  const places = times.flatMap((_, i) => [i, 0, 0]);
  const track = new VectorKeyframeTrack(".position", kind === "given" ? Float64Array.from(times) : times, places);
  if (kind === "laid in") track.times = Float64Array.from(times);
  const different = new Set(track.times).size, valid = track.validate();
  const camera = new Object3D(), mixer = new AnimationMixer(camera);
  mixer.clipAction(new AnimationClip("way", start + 60, [track])).play();
  let off = 0;
  for (let i = 0; i < frames; i++) {
    mixer.setTime(times[i]);
    off = Math.max(off, Math.abs(camera.position.x - i));
  }
  return { different, valid, off, kept: track.clone().optimize().times.length, kind: track.times.constructor.name };
}

const say = (name, r) => console.log(`seen, ${name}: ${r.different} different times of ${frames} (${r.kind}), valid: ${r.valid}, `
  + `up to ${r.off.toFixed(2)} frames off`);
const unix = 1403636579.763555584;
const today = play(unix), given = play(unix, "given"), week = play(550000.1), zero = play(0), laid = play(unix, "laid in");
say("Unix seconds", today);
say("Unix seconds in a Float64Array", given);
say("seconds of the GPS week", week);
say("seconds from the first frame", zero);
say("Unix seconds, laid into track.times", laid);
// An evenly moving track is not to be thinned: give it a bend at every frame.
const bent = new VectorKeyframeTrack(".position", Array.from({ length: frames }, (_, i) => unix + i / 30),
  Array.from({ length: 3 * frames }, (_, i) => Math.sin(i)));
const kept = bent.optimize().times.length;
console.log(`seen: optimize() keeps ${kept} of ${frames} poses that are all different`);
const stands = (r) => r.different === 1 && r.valid && r.off === frames - 1;
process.exit(stands(today) && stands(given) && kept === 2 && week.different < 0.8 * frames && week.off > 0.3 && week.off < 1
  && zero.different === frames && zero.off < 1e-3 && laid.different === frames && laid.off < 1e-3 ? 0 : 1);
JS
node t.mjs 2>&1 || { echo "the behaviour has changed"; exit 1; }
echo "as described: with stamps of today a trajectory stands still"
