// The bar of buttons, keys, the address, and the first frame.

const slider = element("slider"), play = element("play");

function option(name, value) { return new Option(name, value); }
element("sequence").append(...data.sequences.map((sequence, i) => option(sequence.name, i)));
element("sequence-choice").hidden = data.sequences.length < 2;
element("sequence").addEventListener("input", (event) => cursor.go({sequence: Number(event.target.value)}));
element("run").addEventListener("input", (event) => cursor.go({run: Number(event.target.value)}));
slider.addEventListener("input", () => cursor.go({place: Number(slider.value)}));

const player = {
  timer: 0,
  get playing() { return this.timer !== 0; },
  /// One frame on, after as long as the camera took; not faster than can be seen.
  step() {
    const {seconds} = cursor.shown;
    if (cursor.place + 1 >= seconds.length) { this.stop(); return; }
    const wait = Math.min(1, Math.max(0.04, seconds[cursor.place + 1] - seconds[cursor.place]));
    this.timer = setTimeout(() => { cursor.go({place: cursor.place + 1}); this.step(); }, 1000 * wait);
  },
  stop() { clearTimeout(this.timer); this.timer = 0; this.show(); },
  toggle() {
    if (this.playing) { this.stop(); return; }
    if (cursor.place + 1 >= cursor.shown.frames.length) cursor.go({place: 0});
    this.step();
    this.show();
  },
  show() {
    play.textContent = this.playing ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(this.playing));
  },
};

const moves = {
  first: () => cursor.go({place: 0}),
  back: (frames = 1) => cursor.go({place: cursor.place - frames}),
  on: (frames = 1) => cursor.go({place: cursor.place + frames}),
  last: () => cursor.go({place: Infinity}),
};
for (const name of Object.keys(moves)) element(name).addEventListener("click", () => { player.stop(); moves[name](); });
play.addEventListener("click", () => player.toggle());

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  // A list keeps its own keys, a button its space; the slider's arrows are these.
  const on = event.target instanceof Element ? event.target : document.body;
  if (on.closest("select, textarea") || (on.matches("input[type=range]") && on !== slider)) return;
  if (event.key === " " && on.closest("button, input[type=checkbox], summary, a")) return;
  if ((event.key === "Home" || event.key === "End") && !on.closest("#live")) return;
  const frames = event.shiftKey ? 10 : 1;
  const keys = {ArrowLeft: () => moves.back(frames), ArrowRight: () => moves.on(frames), Home: moves.first,
                End: moves.last, " ": () => player.toggle()};
  if (!keys[event.key]) return;
  event.preventDefault();
  if (event.key !== " ") player.stop();
  keys[event.key]();
});

let shownSequence = null, writing = 0;
cursor.followers.push(() => {
  const {shown, shownRun, row} = cursor;
  if (shownSequence !== shown) {
    shownSequence = shown;
    element("sequence").value = cursor.sequence;
    element("run").replaceChildren(...shown.runs.map((run, i) => option(run.name, i)));
    slider.max = shown.frames.length - 1;
  }
  element("run").value = cursor.run;
  slider.value = cursor.place;
  const state = row === undefined ? "not in this run" : shownRun.status[row] + (shownRun.note[row] ? `: ${shownRun.note[row]}` : "");
  element("where").textContent = `Frame ${cursor.frame} · ${shown.seconds[cursor.place].toFixed(2)} s · ${state}`;
  element("where").title = element("where").textContent;
  element("where").classList.toggle("lost", row === undefined || !shownRun.positions[row]);
  // Browsers refuse an address that changes at every frame of a play.
  clearTimeout(writing);
  writing = setTimeout(() => {
    if (location.hash !== hashOfCursor()) history.replaceState(null, "", hashOfCursor());
  }, 250);
});

function redraw() {
  for (const view of [orbit, flatPaths, pictures, framesTable, ...plots.all]) view.soon();
}
window.addEventListener("hashchange", () => {
  goToHash();
  // A link to a frame from far below leads to where the frame is shown.
  const box = element("live").getBoundingClientRect();
  if (location.hash.startsWith("#frame=") && (box.bottom < 0 || box.top > window.innerHeight))
    element("live").scrollIntoView();
});
dark.addEventListener("change", () => cursor.tell());
new ResizeObserver(redraw).observe(element("live"));

element("live").hidden = false;
goToHash();
cursor.tell();

// For whoever writes scripts about a page, as its tests do.
window.stillpointReport = {
  data,
  go: (change) => cursor.go(change),
  get frame() { return cursor.frame; },
  get run() { return cursor.run; },
  screenOf: orbit.screenOf,
  pathScreenOf: flatPaths.screenOf,
};
