// The frame, and over it what the run removed, what truly moves, features, and stages' layers.

const pictures = (() => {
  const canvas = element("picture"), note = element("picture-note"), toggles = element("picture-toggles");
  const fates = [["kept, unmatched", "#f2f2f2"], ["inlier", "#009e73"], ["outlier", "#f0e442"], ["removed", "#d55e00"]];
  const shows = {colour: true, mask: true, truth: true, features: true};
  let opacity = 0.5, sequence = null, wanted = 0;

  const source = (text) => `data:image/${text[0] === "/" ? "jpeg" : "png"};base64,${text}`;

  // The last pictures decoded: going to and fro costs nothing.
  const decoded = new Map();
  function imageOf(text) {
    if (!decoded.has(text)) {
      const image = new Image();
      image.src = source(text);
      decoded.set(text, image.decode().then(() => image, () => null));
      if (decoded.size > 120) decoded.delete(decoded.keys().next().value);
    }
    return decoded.get(text);
  }

  /// The picture nearest to the cursor's frame; undefined where there is none at all.
  function shownPicture() {
    const {frames} = cursor.shown.pictures;
    return frames[nearest(frames.map((picture) => picture.frame), cursor.frame)];
  }

  function layersOf(picture) {
    const run = picture.runs[cursor.run], list = [];
    if (shows.colour) list.push([picture.colour, 1]);
    cursor.shown.pictures.layers.forEach((id, i) => {
      if (shows["layer " + id] && run.layers?.[i]) list.push([run.layers[i], opacity]);
    });
    if (shows.mask && run.mask) list.push([run.mask, opacity]);
    if (shows.truth && picture.truth) list.push([picture.truth, 1]);
    return list;
  }

  function drawFeatures(context, text, scale) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    for (let i = 0; i + 3 < bytes.length; i += 4) {
      const x = bytes[i] | bytes[i + 1] << 8, y = bytes[i + 2] | bytes[i + 3] << 8;
      const [, colour] = fates[x >> 14];
      const at = [((x & 0x3fff) + 0.5) * scale, (y + 0.5) * scale];
      // Told apart by shape as well: squares are removed, crosses are outliers.
      context.strokeStyle = colour;
      context.lineWidth = 1.2;
      context.beginPath();
      if (x >> 14 === 3) context.rect(at[0] - 2.5, at[1] - 2.5, 5, 5);
      else if (x >> 14 === 2) {
        context.moveTo(at[0] - 3, at[1] - 3); context.lineTo(at[0] + 3, at[1] + 3);
        context.moveTo(at[0] - 3, at[1] + 3); context.lineTo(at[0] + 3, at[1] - 3);
      } else context.arc(at[0], at[1], x >> 14 === 1 ? 2.5 : 1, 0, 2 * Math.PI);
      context.stroke();
    }
  }

  async function draw() {
    const picture = shownPicture(), turn = ++wanted;
    note.textContent = told(picture);
    if (!picture) { pen(canvas); return; }
    const layers = layersOf(picture);
    const images = await Promise.all(layers.map(([text]) => imageOf(text)));
    if (turn !== wanted) return;  // the cursor has gone on
    const context = pen(canvas), width = canvas.clientWidth, height = canvas.clientHeight;
    images.forEach((image, i) => {
      if (!image) return;
      context.globalAlpha = layers[i][1];
      context.drawImage(image, 0, 0, width, height);
    });
    context.globalAlpha = 1;
    const {features} = picture.runs[cursor.run];
    if (shows.features && features) drawFeatures(context, features, width / sequence.camera[0]);
    canvas.dataset.frame = picture.frame;
  }

  function told(picture) {
    const text = cursor.shown.pictures.told;
    if (!picture) return text;
    const other = picture.frame === cursor.frame ? "" : `Frame ${cursor.frame} has no picture; this is frame ${picture.frame}. `;
    const bare = shows.mask && !picture.runs[cursor.run].mask ? `${cursor.shownRun.name} removed nothing here. ` : "";
    return other + bare + text;
  }

  const soon = drawsSoon(draw);

  function addToggles() {
    const {frames, layers, size} = sequence.pictures;
    toggles.replaceChildren();
    element("picture-view").hidden = false;
    canvas.style.aspectRatio = `${size[0]} / ${size[1]}`;
    if (frames.length === 0) { canvas.hidden = true; return; }
    canvas.hidden = false;
    const add = (name, words) =>
        addToggle(toggles, words, {type: "checkbox", checked: shows[name] ?? false, name}, (input) => {
          shows[name] = input.checked;
          soon();
        });
    add("colour", "image");
    if (frames.some((picture) => picture.runs.some((run) => run.mask))) add("mask", "mask");
    if (frames.some((picture) => picture.truth)) add("truth", "ground-truth mask");
    if (frames.some((picture) => picture.runs.some((run) => run.features))) add("features", "features");
    layers.forEach((id) => add("layer " + id, id));
    const slider = addToggle(toggles, "opacity", {type: "range", min: 0, max: 1, step: 0.05}, (input) => {
      opacity = Number(input.value);
      soon();
    });
    slider.value = opacity;
    const legend = document.createElement("span");
    legend.className = "legend";
    for (const [words, colour] of [["mask", "#d55e00"], ["ground truth", "#56b4e9"], ...fates])
      legend.append(legendEntry(words, "6px solid", colour));
    toggles.append(legend);
  }

  cursor.followers.push(() => {
    if (sequence !== cursor.shown) {
      sequence = cursor.shown;
      addToggles();
    }
    soon();
  });
  return {canvas, soon};
})();
