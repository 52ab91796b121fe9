// Trajectories in three dimensions, on a plain canvas: some thousand line pieces and points need no WebGL.

const orbit = (() => {
  const canvas = element("orbit"), note = element("orbit-note"), usualNote = note.textContent;
  const view = {target: [0, 0, 0], distance: 1, yaw: 0, pitch: 0};
  const shows = {points: true, keyframes: true, others: true};
  let sequence = null, paths = [], basis = null, hovered = "";

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const plus = (a, b, factor = 1) => a.map((value, i) => value + factor * b[i]);

  /// The directions of the screen in the world: to the right, up, and away from who looks.
  function lookAlong() {
    const up = sequence.up, side = Math.abs(up[2]) > 0.5 ? [1, 0, 0] : [0, 0, 1], front = cross(up, side);
    const level = plus(side.map((v) => v * Math.cos(view.yaw)), front, Math.sin(view.yaw));
    const away = plus(level.map((v) => v * Math.cos(view.pitch)), up, -Math.sin(view.pitch));
    const right = cross(level, up);
    return {right, up: cross(right, away), away};
  }

  /// Px of a point of the world, and how far away it is; null behind who looks.
  function project(p) {
    const d = plus(p, view.target, -1), away = dot(d, basis.away) + view.distance;
    if (away < 0.02 * view.distance) return null;
    const scale = 1.1 * Math.min(canvas.clientWidth, canvas.clientHeight) / away;
    return [canvas.clientWidth / 2 + scale * dot(d, basis.right), canvas.clientHeight / 2 - scale * dot(d, basis.up), away];
  }

  const isShown = (path) => path.truth || path.index === cursor.run || shows.others;

  /// All paths in sight.
  function fit() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const path of paths)
      for (const p of path.positions)
        if (p && isShown(path))
          p.forEach((value, i) => { low[i] = Math.min(low[i], value); high[i] = Math.max(high[i], value); });
    if (low[0] > high[0]) return;
    view.target = low.map((value, i) => (value + high[i]) / 2);
    view.extent = Math.max(0.1, Math.hypot(...low.map((value, i) => high[i] - value)));
    view.distance = 1.35 * view.extent;
  }

  function lookFrom(yaw, pitch) {
    Object.assign(view, {yaw, pitch});
    fit();
    draw();
  }

  function turned([x, y, z, w], v) {
    const t = cross([x, y, z], v).map((value) => 2 * value);
    return plus(plus(v, t, w), cross([x, y, z], t));
  }

  function drawPoints(context, run) {
    const {mm, colours} = run.points, seen = [];
    for (let i = 0; 3 * i < mm.length; ++i) {
      const at = project([mm[3 * i] / 1000, mm[3 * i + 1] / 1000, mm[3 * i + 2] / 1000]);
      if (at) seen.push([at, i]);
    }
    seen.sort((a, b) => b[0][2] - a[0][2]);  // the nearest last
    for (const [at, i] of seen) {
      context.fillStyle = "#" + colours.substr(6 * i, 6);
      context.fillRect(at[0] - 1, at[1] - 1, 2, 2);
    }
  }

  /// A camera as the pyramid it sees.
  function drawCamera(context, run, row, size, colour, width) {
    const at = run.positions[row];
    if (!at) return;
    const [w, h, fx, fy] = sequence.camera, corners = [];
    for (const [x, y] of [[-1, -1], [1, -1], [1, 1], [-1, 1]])
      corners.push(project(plus(at, turned(run.turns[row], [size * x * w / fx / 2, size * y * h / fy / 2, size]))));
    const tip = project(at);
    for (let i = 0; i < 4; ++i)
      strokeLine(context, [tip, corners[i], corners[(i + 1) % 4]], colour, width, []);
  }

  function draw() {
    if (!sequence) return;
    const context = pen(canvas), run = cursor.shownRun;
    basis = lookAlong();
    if (!paths.some((path) => path.positions.some(Boolean))) {
      context.fillStyle = pageColour("--dim");
      context.fillText("No frame has a pose, so there is no trajectory.", 16, 28);
      return;
    }
    if (shows.points) drawPoints(context, run);
    const colourOf = (path) => (path.truth ? pageColour("--truth") : colourOfRun(path.run));
    // The chosen run lies on top.
    const order = paths.filter(isShown).sort((a, b) => (a.index === cursor.run) - (b.index === cursor.run));
    for (const path of order) {
      path.seen = path.positions.map((p) => p && project(p));
      strokeLine(context, path.seen, colourOf(path), path.index === cursor.run ? 2.6 : 1.5, path.dash);
    }
    if (shows.keyframes)
      for (const frame of run.keyframes) {
        const row = run.rowOf.get(frame);
        if (row !== undefined) drawCamera(context, run, row, 0.03 * view.extent, colourOfRun(run), 0.7);
      }
    for (const path of order) {
      if (path.truth) continue;
      const row = path.run.rowOf.get(cursor.frame), p = row !== undefined && path.run.positions[row];
      const at = p && project(p);
      if (at) fillDot(context, at[0], at[1], path.index === cursor.run ? 5 : 3.5, colourOf(path));
    }
    const place = truthAtCursor(sequence), at = place !== undefined && project(sequence.truth.positions[place]);
    if (at) fillDot(context, at[0], at[1], 3.5, pageColour("--truth"));
    if (cursor.row !== undefined) drawCamera(context, run, cursor.row, 0.09 * view.extent, pageColour("--cursor"), 1.8);
    note.textContent = hovered || legend();
  }

  function legend() {
    const run = cursor.shownRun, count = run.points.mm.length / 3;
    const points = shows.points && count < run.points.of ? ` ${count} of ${run.points.of} map points are drawn.` : "";
    const lost = cursor.row !== undefined && !run.positions[cursor.row] ? ` ${run.name} has no pose in this frame.` : "";
    return usualNote + points + lost;
  }

  /// The pose drawn nearest to a place on the canvas.
  function poseAt(x, y) {
    let best = null, least = 12;
    for (const path of paths)
      if (isShown(path) && path.seen)
        path.seen.forEach((at, i) => {
          // The chosen run is the one meant where paths lie over each other.
          const far = at ? Math.hypot(at[0] - x, at[1] - y) - (path.index === cursor.run ? 2 : 0) : Infinity;
          if (far < least) { least = far; best = {path, frame: path.frames[i]}; }
        });
    return best;
  }

  takeHold(canvas, {
    drag(dx, dy, kind) {
      if (kind === "turn") {
        view.yaw -= 0.008 * dx;
        view.pitch = Math.min(1.55, Math.max(-1.55, view.pitch + 0.008 * dy));
      } else {
        const metres = view.distance / (1.1 * Math.min(canvas.clientWidth, canvas.clientHeight));
        view.target = plus(plus(view.target, basis.right, -dx * metres), basis.up, dy * metres);
      }
      soon();
    },
    zoom(factor) {
      view.distance = Math.min(100 * view.extent, Math.max(0.02 * view.extent, view.distance / factor));
      soon();
    },
    hover(x, y) {
      const pose = poseAt(x, y);
      canvas.style.cursor = pose ? "pointer" : "grab";
      const text = pose ? `${pose.path.name}, frame ${pose.frame}; a click goes there.` : "";
      if (text !== hovered) { hovered = text; note.textContent = hovered || legend(); }
    },
    leave() { hovered = ""; note.textContent = legend(); },
    click(x, y) {
      const pose = poseAt(x, y);
      if (pose) cursor.go(pose.path.truth ? {frame: pose.frame} : {frame: pose.frame, run: pose.path.index});
    },
  });
  const soon = drawsSoon(draw);
  canvas.addEventListener("dblclick", () => { fit(); soon(); });

  const toggles = element("orbit-toggles");
  addButton(toggles, "Oblique", "From above at a slant", () => lookFrom(0.6, 0.5));
  addButton(toggles, "Top", "From straight above", () => lookFrom(0, 1.55));
  addButton(toggles, "Level", "From the side", () => lookFrom(0, 0));
  addButton(toggles, "Fit", "All paths in sight (double click)", () => { fit(); soon(); });
  for (const [name, words] of [["points", "map"], ["keyframes", "keyframes"], ["others", "other runs"]])
    addToggle(toggles, words, {type: "checkbox", checked: true}, (input) => { shows[name] = input.checked; soon(); });

  const key = document.createElement("span");
  key.className = "legend";
  toggles.append(key);

  cursor.followers.push(() => {
    if (sequence !== cursor.shown) {
      sequence = cursor.shown;
      paths = pathsOf(sequence);
      Object.assign(view, {yaw: 0.6, pitch: 0.5, extent: 1});
      fit();
    }
    key.replaceChildren(...paths.map((path) =>
        path.truth ? legendEntry(path.name, "3px solid", pageColour("--truth"))
                   : legendEntry(path.name, lineOf(path.run), colourOfRun(path.run))));
    soon();
  });
  /// Where on the canvas a run's frame is drawn, px; for scripts.
  const screenOf = (run, frame) => {
    draw();
    const row = sequence.runs[run].rowOf.get(frame), p = row !== undefined && sequence.runs[run].positions[row];
    return p ? project(p) : null;
  };
  return {canvas, soon, screenOf};
})();
