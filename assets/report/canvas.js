// Canvases as sharp as the screen, in the page's colours.

const dark = matchMedia("(prefers-color-scheme: dark)");
const colourOfRun = (run) => run.colours[dark.matches ? 1 : 0];
const pageColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/// The canvas's pen, its unit a pixel of the page; cleared.
function pen(canvas) {
  const sharp = window.devicePixelRatio || 1;
  const width = Math.max(1, Math.round(canvas.clientWidth * sharp));
  const height = Math.max(1, Math.round(canvas.clientHeight * sharp));
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
  const context = canvas.getContext("2d");
  context.setTransform(sharp, 0, 0, sharp, 0, 0);
  context.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  return context;
}

/// A function that draws at the browser's next turn, however often it is called before.
function drawsSoon(draw) {
  let asked = false;
  return () => {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => { asked = false; draw(); });
  };
}

/// Strokes a line through points; null breaks it. @param points [x, y] px
function strokeLine(context, points, colour, width, dash) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.lineJoin = "round";
  context.setLineDash(dash);
  context.beginPath();
  let broken = true;
  points.forEach((point, i) => {
    if (point) {
      if (broken) context.moveTo(point[0], point[1]); else context.lineTo(point[0], point[1]);
      // A point alone between gaps is seen as well.
      if (broken && !points[i + 1]) context.lineTo(point[0] + 0.5, point[1]);
    }
    broken = !point;
  });
  context.stroke();
  context.setLineDash([]);
}

function fillDot(context, x, y, radius, colour) {
  context.fillStyle = colour;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}

/// What a mouse or fingers do on a canvas. @param on {drag(dx, dy, kind), zoom(factor, x, y), hover(x, y), click(x, y),
/// leave()}; kind is "move" with the right button, Shift or two fingers, else "turn"
function takeHold(canvas, on) {
  const held = new Map();
  let travelled = 0;
  const spread = () => {
    const [a, b] = [...held.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (held.size === 0) travelled = 0;
    try { canvas.setPointerCapture(event.pointerId); } catch { /* a pointer made by a script */ }
    held.set(event.pointerId, {x: event.offsetX, y: event.offsetY});
  });
  canvas.addEventListener("pointermove", (event) => {
    const at = held.get(event.pointerId);
    if (!at) { on.hover?.(event.offsetX, event.offsetY); return; }
    const dx = event.offsetX - at.x, dy = event.offsetY - at.y, before = held.size === 2 ? spread() : 0;
    held.set(event.pointerId, {x: event.offsetX, y: event.offsetY});
    travelled += Math.abs(dx) + Math.abs(dy);
    if (before > 0) on.zoom?.(spread() / before, event.offsetX, event.offsetY);
    const moves = held.size === 2 || event.shiftKey || (event.buttons & 6) !== 0;
    on.drag?.(dx / held.size, dy / held.size, moves ? "move" : "turn", event.offsetX, event.offsetY);
  });
  const letGo = (event) => {
    if (held.delete(event.pointerId) && event.type === "pointerup" && travelled < 4 && event.button === 0)
      on.click?.(event.offsetX, event.offsetY);
  };
  canvas.addEventListener("pointerup", letGo);
  canvas.addEventListener("pointercancel", letGo);
  canvas.addEventListener("pointerleave", () => on.leave?.());
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  if (on.zoom)
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      on.zoom(Math.exp(-0.0015 * event.deltaY * (event.deltaMode === 1 ? 20 : 1)), event.offsetX, event.offsetY);
    }, {passive: false});
}
