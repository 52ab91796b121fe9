// What is looked at: a sequence, a run of it, a frame. Every view follows the cursor, and none knows another.

const data = JSON.parse(document.getElementById("report-data").textContent);
const element = (id) => document.getElementById(id);

// A sequence's frames are those of any of its runs; a run's lists have a row for each of its own.
for (const sequence of data.sequences) {
  const seconds = new Map();
  for (const run of sequence.runs) {
    run.rowOf = new Map(run.frames.map((frame, row) => [frame, row]));
    run.frames.forEach((frame, row) => seconds.set(frame, run.seconds[row]));
  }
  sequence.frames = [...seconds.keys()].sort((a, b) => a - b);
  sequence.seconds = sequence.frames.map((frame) => seconds.get(frame));
}

/// The place in a sorted list of the value nearest to one.
function nearest(sorted, value) {
  let low = 0, high = sorted.length - 1;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (sorted[middle] < value) low = middle + 1; else high = middle;
  }
  return low > 0 && value - sorted[low - 1] <= sorted[low] - value ? low - 1 : low;
}

const cursor = {
  sequence: 0, run: 0, place: 0,  // place: among the sequence's frames
  followers: [],

  get shown() { return data.sequences[this.sequence]; },
  get shownRun() { return this.shown.runs[this.run]; },
  get frame() { return this.shown.frames[this.place]; },
  /// The frame's row in the shown run; undefined where the run has not got that far.
  get row() { return this.shownRun.rowOf.get(this.frame); },

  /// @param change any of sequence, run, frame, place
  go(change) {
    const within = (index, list) => Math.min(Math.max(index, 0), list.length - 1);
    const before = [this.sequence, this.run, this.place].join();
    if (change.sequence !== undefined) {
      const sequence = within(change.sequence, data.sequences);
      if (sequence !== this.sequence) this.run = this.place = 0;
      this.sequence = sequence;
    }
    if (change.run !== undefined) this.run = within(change.run, this.shown.runs);
    if (change.frame !== undefined) this.place = nearest(this.shown.frames, change.frame);
    if (change.place !== undefined) this.place = within(change.place, this.shown.frames);
    if (before !== [this.sequence, this.run, this.place].join()) this.tell();
  },
  tell() { for (const follower of this.followers) follower(); },
};

/// "#frame=417", "#frame=417&run=2&sequence=1": runs and sequences are counted from 1.
function goToHash() {
  const wanted = new URLSearchParams(location.hash.slice(1)), change = {};
  const number = (key) => (/^\d+$/.test(wanted.get(key) ?? "") ? Number(wanted.get(key)) : undefined);
  if (number("sequence") !== undefined) change.sequence = number("sequence") - 1;
  if (number("run") !== undefined) change.run = number("run") - 1;
  if (number("frame") !== undefined) change.frame = number("frame");
  cursor.go(change);
}

/// The cursor as a link's end.
function hashOfCursor() {
  return `#frame=${cursor.frame}` + (cursor.run > 0 ? `&run=${cursor.run + 1}` : "") +
      (cursor.sequence > 0 ? `&sequence=${cursor.sequence + 1}` : "");
}

const figureNamed = (name) => data.figures.find((figure) => figure.name === name);

/// A figure as people read it; a dash where it is not known.
function shownValue(figure, value) {
  if (value === null || value === undefined) return "–";
  if (figure.truth) return value ? "yes" : "no";
  return (figure.factor * value).toFixed(figure.digits);
}

const withUnit = (figure) => figure.title + (figure.unit ? `, ${figure.unit}` : "");

/// A checkbox or another control with its words. @param changed called with the control
function addToggle(parent, words, attributes, changed) {
  const label = document.createElement("label"), input = document.createElement("input");
  Object.assign(input, attributes);
  input.addEventListener("input", () => changed(input));
  if (attributes.type === "checkbox") label.append(input, " " + words); else label.append(words + " ", input);
  parent.append(label);
  return input;
}

function addButton(parent, words, title, pressed) {
  const button = document.createElement("button");
  Object.assign(button, {type: "button", textContent: words, title});
  button.addEventListener("click", pressed);
  parent.append(button);
  return button;
}

/// Words with the colour they stand for. @param line CSS of its border: "3px solid"
function legendEntry(words, line, colour) {
  const entry = document.createElement("span"), key = document.createElement("i");
  key.style.borderTop = `${line} ${colour}`;
  entry.append(key, words);
  return entry;
}

const lineOf = (run) => `3px ${run.dash.length ? "dashed" : "solid"}`;
