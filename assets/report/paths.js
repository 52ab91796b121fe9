// All paths in one scale, seen from the side that shows most of them.

const flatPaths = (() => {
  const canvas = element("paths"), note = element("paths-note");
  const edges = {left: 62, right: 14, top: 10, bottom: 34};  // px
  let sequence = null, paths = [], axes = [0, 1], box = null;

  /// The two axes along which the paths reach furthest, in their order, and what they reach over.
  function look() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const path of paths)
      for (const p of path.positions)
        if (p) p.forEach((value, i) => { low[i] = Math.min(low[i], value); high[i] = Math.max(high[i], value); });
    box = low[0] <= high[0] ? {low, high} : null;
    if (!box) return;
    axes = [0, 1, 2].sort((a, b) => (high[b] - low[b]) - (high[a] - low[a]) || a - b).slice(0, 2).sort();
  }

  /// Metres to px: one scale for both axes, the paths in the middle.
  function map() {
    const [a, b] = axes, width = canvas.clientWidth - edges.left - edges.right,
          height = canvas.clientHeight - edges.top - edges.bottom;
    const span = (axis) => 1.1 * Math.max(box.high[axis] - box.low[axis], 0.01);
    const scale = Math.max(1e-6, Math.min(width / span(a), height / span(b)));
    const middle = (axis) => (box.low[axis] + box.high[axis]) / 2;
    return {
      scale, low: [middle(a) - width / scale / 2, middle(b) - height / scale / 2],
      high: [middle(a) + width / scale / 2, middle(b) + height / scale / 2],
      x: (value) => edges.left + width / 2 + scale * (value - middle(a)),
      y: (value) => edges.top + height / 2 - scale * (value - middle(b)),
    };
  }

  function drawAxes(context, at) {
    const names = axes.map((axis) => "xyz"[axis]), right = canvas.clientWidth - edges.right,
          bottom = canvas.clientHeight - edges.bottom;
    context.font = "12px system-ui, sans-serif";
    const line = (points) => strokeLine(context, points, pageColour("--grid"), 1, []);
    const xs = ticks(at.low[0], at.high[0], Math.max(2, canvas.clientWidth / 110)),
          ys = ticks(at.low[1], at.high[1], Math.max(2, canvas.clientHeight / 60));
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const x of xs.list) {
      line([[at.x(x), edges.top], [at.x(x), bottom]]);
      context.fillStyle = pageColour("--dim");
      context.fillText(x.toFixed(xs.digits), at.x(x), bottom + 5);
    }
    context.fillText(`${names[0]}, m`, (edges.left + right) / 2, bottom + 19);
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const y of ys.list) {
      line([[edges.left, at.y(y)], [right, at.y(y)]]);
      context.fillStyle = pageColour("--dim");
      context.fillText(y.toFixed(ys.digits), edges.left - 6, at.y(y));
    }
    context.save();
    context.translate(13, (edges.top + bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText(`${names[1]}, m`, 0, 0);
    context.restore();
  }

  function draw() {
    if (!sequence) return;
    const context = pen(canvas);
    if (!box) {
      context.fillStyle = pageColour("--dim");
      context.fillText("No run has poses.", 16, 28);
      return;
    }
    const at = map();
    drawAxes(context, at);
    const order = [...paths].sort((a, b) => (a.index === cursor.run) - (b.index === cursor.run));
    for (const path of order) {
      path.flat = path.positions.map((p) => p && [at.x(p[axes[0]]), at.y(p[axes[1]])]);
      strokeLine(context, path.flat, path.truth ? pageColour("--truth") : colourOfRun(path.run),
                 path.truth || path.index === cursor.run ? 2.4 : 1.5, path.dash);
    }
    for (const path of order) {
      const row = path.truth ? truthAtCursor(sequence) : path.run.rowOf.get(cursor.frame);
      const p = row !== undefined && (path.truth ? sequence.truth : path.run).positions[row];
      if (p) fillDot(context, at.x(p[axes[0]]), at.y(p[axes[1]]), path.index === cursor.run ? 5 : 3.5,
                     path.truth ? pageColour("--truth") : colourOfRun(path.run));
    }
  }

  /// The pose drawn nearest to a place on the canvas.
  function poseAt(x, y) {
    let best = null, least = 12;
    for (const path of paths)
      path.flat?.forEach((at, i) => {
        const far = at ? Math.hypot(at[0] - x, at[1] - y) - (path.index === cursor.run ? 2 : 0) : Infinity;
        if (far < least) { least = far; best = {path, frame: path.frames[i]}; }
      });
    return best;
  }

  takeHold(canvas, {
    hover(x, y) { canvas.style.cursor = poseAt(x, y) ? "pointer" : "default"; },
    click(x, y) {
      const pose = poseAt(x, y);
      if (pose) cursor.go(pose.path.truth ? {frame: pose.frame} : {frame: pose.frame, run: pose.path.index});
    },
  });
  const soon = drawsSoon(draw);

  cursor.followers.push(() => {
    if (sequence !== cursor.shown) {
      sequence = cursor.shown;
      paths = pathsOf(sequence);
      look();
      const names = axes.map((axis) => "xyz"[axis]);
      note.textContent = `All runs in one scale, along ${names[0]} and ${names[1]}, the two axes in which the camera ` +
          "went furthest. A click on a path goes to its frame.";
    }
    element("paths-legend").replaceChildren(...paths.map((path) =>
        path.truth ? legendEntry(path.name, "3px solid", pageColour("--truth"))
                   : legendEntry(path.name, lineOf(path.run), colourOfRun(path.run))));
    soon();
  });
  /// Where on the canvas a run's frame is drawn, px; for scripts.
  const screenOf = (run, frame) => {
    const row = sequence.runs[run].rowOf.get(frame), p = row !== undefined && sequence.runs[run].positions[row];
    const at = p && map();
    return p ? [at.x(p[axes[0]]), at.y(p[axes[1]])] : null;
  };
  return {canvas, soon, screenOf};
})();
