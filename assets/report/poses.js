// Poses number by number, and the paths they make: what several views draw.

const poseInfos = [
  ...["x", "y", "z"].map((name) => ({name, title: `Position ${name}`, unit: "m", factor: 1, digits: 3, isPose: true})),
  ...["roll", "pitch", "yaw"].map((name) => ({name, title: `Angle ${name}`, unit: "°", factor: 1, digits: 2, isPose: true})),
];

/// Degrees about x, y and z, of R = Rz(yaw) Ry(pitch) Rx(roll). @param q x, y, z, w
function anglesOf([x, y, z, w]) {
  const degrees = (radians) => radians * 180 / Math.PI;
  return [degrees(Math.atan2(2 * (y * z + w * x), 1 - 2 * (x * x + y * y))),
          degrees(Math.atan2(2 * (w * y - x * z),
                             Math.hypot(1 - 2 * (y * y + z * z), 2 * (x * y + w * z)))),
          degrees(Math.atan2(2 * (x * y + w * z), 1 - 2 * (y * y + z * z)))];
}

/// {x, y, z, roll, pitch, yaw}, a value a pose; null where there is none. Angles are turned on past ±180° rather
/// than jump. @param near angles that the first ones are to be next to, by whole turns
function posesOf(positions, turns, near) {
  const poses = Object.fromEntries(poseInfos.map((info) => [info.name, []]));
  let last = near;
  positions.forEach((position, i) => {
    const angles = turns[i] && anglesOf(turns[i]).map((now, k) => (last ? now - 360 * Math.round((now - last[k]) / 360) : now));
    last = angles || last;
    ["x", "y", "z"].forEach((name, k) => poses[name].push(position ? position[k] : null));
    ["roll", "pitch", "yaw"].forEach((name, k) => poses[name].push(angles ? angles[k] : null));
  });
  return poses;
}

const firstAngles = (turns) => { const first = turns.find(Boolean); return first && anglesOf(first); };

for (const sequence of data.sequences) {
  const {truth, runs} = sequence;
  const near = firstAngles(truth.turns) ?? runs.map((run) => firstAngles(run.turns)).find(Boolean);
  truth.pose = posesOf(truth.positions, truth.turns, near);
  for (const run of runs) run.pose = posesOf(run.positions, run.turns, near);
}

/// A sequence's paths, the truth first. A path's frames say where a click on it goes to.
function pathsOf(shown) {
  const all = [];
  if (shown.truth.positions.some(Boolean))
    all.push({name: "ground truth", positions: shown.truth.positions, truth: true, dash: [],
              frames: shown.truth.seconds.map((s) => shown.frames[nearest(shown.seconds, s)])});
  shown.runs.forEach((run, index) => {
    // Frames the run does not have break the line as those without a pose do.
    const positions = [], frames = [];
    run.frames.forEach((frame, row) => {
      if (row > 0 && frame !== run.frames[row - 1] + 1) { positions.push(null); frames.push(frame); }
      positions.push(run.positions[row]);
      frames.push(frame);
    });
    all.push({name: run.name, run, index, positions, frames, dash: run.dash});
  });
  return all;
}

/// The place in the truth's lists that is of the cursor's frame; undefined where none is near.
function truthAtCursor(shown) {
  const {seconds} = shown.truth, now = shown.seconds[cursor.place];
  if (seconds.length === 0) return undefined;
  const i = nearest(seconds, now);
  return Math.abs(seconds[i] - now) < 0.1 && shown.truth.positions[i] ? i : undefined;
}

/// Round numbers, some `count` of them, from `low` to `high`.
function ticks(low, high, count) {
  const raw = (high - low) / Math.max(1, count), power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => size >= raw) ?? raw;
  const list = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) list.push(i * step);
  return {list, digits: Math.max(0, Math.min(6, -Math.floor(Math.log10(step) + 1e-9)))};
}
