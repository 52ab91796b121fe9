// Figures of all runs over time, under one another, with one range of time and the cursor in all of them.

const plots = (() => {
  const edges = {left: 62, right: 12, top: 8, bottom: 24};  // px
  const range = {from: 0, to: 1};                           // s, of all plots
  const all = [];

  const end = () => Math.max(1e-3, cursor.shown.seconds[cursor.shown.seconds.length - 1]);

  const valuesOf = (run, figure) => (figure.isPose ? run.pose : run.figures)[figure.name];

  /// [seconds, value] a frame; null where the value is not known, and where frames are missing between.
  function curveOf(run, figure) {
    const values = valuesOf(run, figure), curve = [];
    run.frames.forEach((frame, row) => {
      if (row > 0 && frame !== run.frames[row - 1] + 1) curve.push(null);
      curve.push(values[row] === null ? null : [run.seconds[row], figure.factor * values[row]]);
    });
    return curve;
  }

  /// Stretches of time in which the run had no pose.
  function lostStretches(run) {
    const stretches = [];
    run.positions.forEach((position, row) => {
      if (position) return;
      const from = run.seconds[row], to = run.seconds[row + 1] ?? from, before = stretches[stretches.length - 1];
      if (before && before[1] >= from) before[1] = to; else stretches.push([from, to]);
    });
    return stretches;
  }

  /// @param chooses what of it is chosen: a list of figures, or the name of the one there is
  function addPlot(parent, chooses, infoShown) {
    const figure = document.createElement("figure"), canvas = document.createElement("canvas");
    const head = document.createElement("div");
    const legend = document.createElement("span");
    figure.className = "plot";
    head.className = "toggles";
    legend.className = "legend";
    canvas.setAttribute("role", "img");
    head.append(chooses, legend);
    figure.append(head, canvas);
    parent.append(figure);

    const xOf = (s) => edges.left + (s - range.from) / (range.to - range.from) * (canvas.clientWidth - edges.left - edges.right);
    const secondsAt = (x) => range.from + (x - edges.left) / Math.max(1, canvas.clientWidth - edges.left - edges.right) * (range.to - range.from);

    function draw() {
      const context = pen(canvas), info = infoShown(), {runs, truth} = cursor.shown;
      const width = canvas.clientWidth, bottom = canvas.clientHeight - edges.bottom;
      canvas.setAttribute("aria-label", `${withUnit(info)} over time`);
      const curves = runs.map((run) => curveOf(run, info));
      const trueCurve = info.isPose ? truth.pose[info.name].map((value, i) => value === null ? null : [truth.seconds[i], value]) : [];
      let low = Infinity, high = -Infinity;
      for (const curve of [...curves, trueCurve])
        for (const point of curve)
          if (point && point[0] >= range.from && point[0] <= range.to) {
            low = Math.min(low, point[1]);
            high = Math.max(high, point[1]);
          }
      const known = low <= high;
      if (!known) [low, high] = [0, 1];
      if (low >= 0 && !info.isPose) low = 0;
      // What stands still is drawn as standing still, not as the noise of its last digit.
      const least = !info.isPose ? 1e-12 : info.unit === "m" ? 0.01 : 0.1;
      if (high - low < least) [low, high] = info.isPose ? [(low + high - least) / 2, (low + high + least) / 2] : [low, low + 1];
      if (info.isPose) low -= 0.06 * (high - low);
      high += 0.06 * (high - low);
      const yOf = (value) => bottom - (value - low) / (high - low) * (bottom - edges.top);

      context.font = "12px system-ui, sans-serif";
      context.fillStyle = pageColour("--lost");
      for (const [from, to] of lostStretches(cursor.shownRun))
        context.fillRect(xOf(from), edges.top, Math.max(2, xOf(to) - xOf(from)), bottom - edges.top);
      context.textBaseline = "middle";
      context.textAlign = "right";
      const ys = ticks(low, high, 4);
      for (const y of ys.list) {
        strokeLine(context, [[edges.left, yOf(y)], [width - edges.right, yOf(y)]], pageColour("--grid"), 1, []);
        context.fillStyle = pageColour("--dim");
        context.fillText(y.toFixed(ys.digits), edges.left - 6, yOf(y));
      }
      context.textBaseline = "top";
      context.textAlign = "center";
      const xs = ticks(range.from, range.to, Math.max(2, width / 110));
      for (const x of xs.list)
        if (xOf(x) < width - 24) context.fillText(x.toFixed(xs.digits) + " s", xOf(x), bottom + 7);
      if (!known) context.fillText("not known of any frame here", width / 2, (edges.top + bottom) / 2);

      context.save();
      context.beginPath();
      context.rect(edges.left, 0, width - edges.left - edges.right, canvas.clientHeight);
      context.clip();
      strokeLine(context, trueCurve.map((point) => point && [xOf(point[0]), yOf(point[1])]), pageColour("--truth"), 2.4, []);
      const order = runs.map((_, i) => i).sort((a, b) => (a === cursor.run) - (b === cursor.run));
      for (const i of order)
        strokeLine(context, curves[i].map((point) => point && [xOf(point[0]), yOf(point[1])]), colourOfRun(runs[i]),
                   i === cursor.run ? 2 : 1.3, runs[i].dash);
      const now = xOf(cursor.shown.seconds[cursor.place]);
      strokeLine(context, [[now, edges.top], [now, bottom]], pageColour("--cursor"), 1.5, []);
      for (const i of order) {
        const row = runs[i].rowOf.get(cursor.frame), value = row === undefined ? null : valuesOf(runs[i], info)[row];
        if (value !== null) fillDot(context, now, yOf(info.factor * value), 3.5, colourOfRun(runs[i]));
      }
      context.restore();
    }

    /// Each run's value at the cursor, which is what a plot alone does not tell.
    function tell() {
      const info = infoShown();
      const entries = cursor.shown.runs.map((run) => {
        const row = run.rowOf.get(cursor.frame);
        const value = row === undefined ? null : valuesOf(run, info)[row];
        return legendEntry(`${run.name} ${shownValue(info, value)}`, lineOf(run), colourOfRun(run));
      });
      const {truth} = cursor.shown;
      if (info.isPose && truth.positions.some(Boolean)) {
        const place = truthAtCursor(cursor.shown), value = place === undefined ? null : truth.pose[info.name][place];
        entries.unshift(legendEntry(`ground truth ${shownValue(info, value)}`, "3px solid", pageColour("--truth")));
      }
      legend.replaceChildren(...entries);
    }

    const soon = drawsSoon(draw);
    const goTo = (x) => cursor.go({place: nearest(cursor.shown.seconds, secondsAt(x))});
    takeHold(canvas, {
      click: goTo,
      drag(dx, dy, kind, x) {
        if (kind === "turn") { goTo(x); return; }
        const by = secondsAt(0) - secondsAt(dx);
        setRange(range.from + by, range.to + by);
      },
      zoom(factor, x) {
        const at = secondsAt(x);
        setRange(at - (at - range.from) / factor, at + (range.to - at) / factor);
      },
    });
    canvas.addEventListener("dblclick", () => setRange(0, end()));
    all.push({canvas, soon, tell});
    return all[all.length - 1];
  }

  /// A plot of any figure.
  function addFigurePlot(wanted) {
    const select = document.createElement("select");
    select.setAttribute("aria-label", "Figure");
    for (const info of data.figures) {
      const option = new Option(withUnit(info), info.name);
      option.title = info.help;
      select.append(option);
    }
    select.value = wanted;
    const plot = addPlot(element("plots"), select, () => figureNamed(select.value));
    select.addEventListener("input", () => { plot.tell(); plot.soon(); });
    plot.select = select;
  }

  function addPosePlot(info) {
    const name = document.createElement("strong");
    name.textContent = withUnit(info);
    addPlot(element("poses"), name, () => info);
  }

  /// Within the sequence, and no less than some frames of it.
  function setRange(from, to) {
    const least = Math.min(end(), Math.max(0.05, 5 * end() / cursor.shown.frames.length));
    const length = Math.min(end(), Math.max(least, to - from));
    range.from = Math.min(Math.max(0, from), end() - length);
    range.to = range.from + length;
    for (const plot of all) plot.soon();
  }

  const isKnown = (name) => cursor.shown.runs.some((run) => run.figures[name]?.some((value) => value !== null));
  const usual = ["rpe_1s", "rpe", "inliers", "mask", "ms.total"];

  /// Plots of what the sequence knows nothing of show something that it knows.
  function chooseFigures() {
    const chosen = all.filter((plot) => plot.select);
    for (const plot of chosen) {
      if (isKnown(plot.select.value)) continue;
      const free = usual.find((name) => isKnown(name) && chosen.every((other) => other.select.value !== name));
      if (free) plot.select.value = free;
    }
  }

  for (const name of usual.filter(figureNamed).slice(0, 2)) addFigurePlot(name);
  for (const info of poseInfos) addPosePlot(info);

  let sequence = null;
  cursor.followers.push(() => {
    if (sequence !== cursor.shown) {
      sequence = cursor.shown;
      chooseFigures();
      setRange(0, end());
    }
    const now = sequence.seconds[cursor.place], length = range.to - range.from;
    if (now < range.from || now > range.to) setRange(now - length / 2, now + length / 2);
    for (const plot of all) { plot.tell(); plot.soon(); }
  });
  return {all};
})();
