// The sheet as it is drawn: layers, moving and zooming, the hinges by strain class, and picking one of them.
// Drawing coordinates are sheet millimetres with y down.

const SHEET = DATA.sheet;
const drawing = byId("drawing");
// The part of the sheet that is shown: left, top, width, height.
let view = SHEET.view.slice();
const at = (id) => (SHEET.places ? SHEET.places[id] : [HINGES.x[id], -HINGES.y[id]]);
// Sheets of more hinges are painted on a canvas, which a gesture moves and stretches; it is painted anew when that rests.
const MANY = 4000;
const canvas = COUNT > MANY ? element("canvas", { "aria-hidden": "true" }) : null;

function dots(ids) {
  return ids.map((id) => `M${fixed(at(id)[0], 2)} ${fixed(at(id)[1], 2)}h0`).join("");
}

const allIds = Array.from({ length: COUNT }, (_, id) => id);

function buildSheet() {
  const shapes = drawn("defs");
  const body = drawn("g");
  for (const layer of SHEET.layers) {
    shapes.append(drawn("path", { id: `shape-${layer.id}`, d: layer.d }));
    body.append(drawn("use", { href: `#shape-${layer.id}`, class: `layer ${layer.class}`, "data-layer": layer.id }));
  }
  const hinges = drawn("g", { "data-layer": "hinges" });
  CLASSES.forEach((_, index) => hinges.append(drawn("path", { class: `layer class-${index}`, id: `dots-${index}` })));
  const look = drawn("g", { "data-layer": "look" });
  for (const verdict of ["warn", "fail"]) {
    const ids = allIds.filter((id) => word("verdict", id) === verdict);
    if (ids.length > 0) look.append(drawn("path", { class: `layer look-${verdict}`, id: `look-${verdict}` }));
  }
  if (canvas) {
    [body, hinges, look].forEach((group) => group.setAttribute("visibility", "hidden"));
    byId("stage").prepend(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", paint);
    byId("theme").addEventListener("click", paint);
  }
  drawing.append(shapes, body, hinges, look, drawn("circle", { id: "pick", r: 0, visibility: "hidden" }));
  layerBoxes(look.childElementCount > 0);
  colourHinges();
  onLoads.push(colourHinges);
  onPick.push(ringPick);
  placeView();
  gestures();
  keys();
  byId("zoom-in").addEventListener("click", () => zoom(0.6));
  byId("zoom-out").addEventListener("click", () => zoom(1 / 0.6));
  byId("zoom-fit").addEventListener("click", fitView);
  new ResizeObserver(placeView).observe(byId("stage"));
}

function layerBoxes(look) {
  const all = SHEET.layers.map(({ id, label, off }) => [id, label, off]);
  all.push(["hinges", "hinges", false]);
  if (look) all.push(["look", "to look at", false]);
  for (const [id, label, off] of all) {
    const layer = drawing.querySelector(`[data-layer="${id}"]`);
    const show = (on) => layer.setAttribute("display", on ? "inline" : "none");
    const box = element("input", { type: "checkbox", id: `layer-${id}`, onchange: () => {
      show(box.checked);
      paint();
    } });
    box.checked = !off;
    show(!off);
    byId("layers").append(element("label", {}, box, ` ${label}`));
  }
}

function colourHinges() {
  CLASSES.forEach((_, index) => {
    byId(`dots-${index}`).setAttribute("d", dots(allIds.filter((id) => shown.loads.class[id] === index)));
  });
  const legend = byId("legend");
  legend.replaceChildren();
  const counts = [0, 0, 0];
  shown.loads.class.forEach((index) => (counts[index] += 1));
  CLASSES.forEach((name, index) => {
    const swatch = element("span", { class: "swatch", style: `background: var(--class-${index})` });
    legend.append(element("span", {}, swatch, `${name}: ${counts[index]}`));
  });
  if (shown.altered) legend.append(element("strong", {}, "what-if values "));
  paint();
}

// Millimetres of the sheet per pixel of the screen.
function scale() {
  const { clientWidth, clientHeight } = byId("stage");
  return Math.max(view[2] / Math.max(clientWidth, 1), view[3] / Math.max(clientHeight, 1));
}

let drawnView = view;

function placeView() {
  drawing.style.transform = "";
  drawing.setAttribute("viewBox", view.map((value) => fixed(value, 4)).join(" "));
  drawnView = view.slice();
  const pixel = scale();
  const dot = Math.min(Math.max(SHEET.hinge, 4.5 * pixel), 9 * pixel);
  drawing.querySelectorAll(".layer").forEach((layer) => layer.setAttribute("stroke-width", fixed(pixel, 5)));
  CLASSES.forEach((_, index) => byId(`dots-${index}`).setAttribute("stroke-width", fixed(dot, 4)));
  placeRings(0.85 * dot, 1.4 * pixel);
  byId("pick").setAttribute("stroke-width", fixed(3 * pixel, 4));
  byId("pick").setAttribute("r", fixed(1.6 * dot, 4));
  paint();
}

const outlines = new Map();

// A path of the drawing for the canvas; kept while its data stay the same.
function outline(shape) {
  const data = shape.getAttribute("d") ?? "";
  if (outlines.get(shape)?.data !== data) outlines.set(shape, { data, path: new Path2D(data) });
  return outlines.get(shape).path;
}

// Paints what the hidden layers of the drawing hold, in their styles.
function paint() {
  if (!canvas) return;
  const { clientWidth, clientHeight } = byId("stage");
  const sharp = window.devicePixelRatio || 1;
  [canvas.width, canvas.height] = [clientWidth * sharp, clientHeight * sharp];
  canvas.style.transform = "";
  const frame = framed(view, Math.max(clientWidth, 1), Math.max(clientHeight, 1));
  const factor = sharp / frame.pixel;
  const context = canvas.getContext("2d");
  context.setTransform(factor, 0, 0, factor, -frame.left * factor, -frame.top * factor);
  [context.lineCap, context.lineJoin] = ["round", "round"];
  for (const layer of drawing.querySelectorAll(".layer")) {
    if (layer.closest('[display="none"]')) continue;
    const style = getComputedStyle(layer);
    const href = layer.getAttribute("href");
    const path = outline(href ? drawing.querySelector(href) : layer);
    if (style.fill !== "none") {
      context.fillStyle = style.fill;
      context.fill(path);
    }
    if (style.stroke !== "none") {
      context.strokeStyle = style.stroke;
      context.lineWidth = Number(layer.getAttribute("stroke-width"));
      context.stroke(path);
    }
  }
}

function placeRings(radius, width) {
  const [r, d] = [fixed(radius, 3), fixed(2 * radius, 3)];
  for (const verdict of ["warn", "fail"]) {
    const path = byId(`look-${verdict}`);
    if (!path) continue;
    const ids = allIds.filter((id) => word("verdict", id) === verdict);
    const ring = (id) => `M${fixed(at(id)[0] - radius, 3)} ${fixed(at(id)[1], 3)}a${r} ${r} 0 1 0 ${d} 0a${r} ${r} 0 1 0 -${d} 0`;
    path.setAttribute("d", ids.map(ring).join(""));
    path.setAttribute("stroke-width", fixed(width, 4));
  }
}

let resting = 0;
let asked = false;

function viewChanged() {
  clearTimeout(resting);
  if (!canvas) {
    if (asked) return;
    asked = true;
    requestAnimationFrame(() => {
      asked = false;
      placeView();
    });
    return;
  }
  const { clientWidth, clientHeight } = byId("stage");
  const [before, after] = [framed(drawnView, clientWidth, clientHeight), framed(view, clientWidth, clientHeight)];
  const factor = before.pixel / after.pixel;
  const shift = [(before.left - after.left) / after.pixel, (before.top - after.top) / after.pixel];
  const change = `translate(${shift[0]}px, ${shift[1]}px) scale(${factor})`;
  [canvas, drawing].forEach((picture) => (picture.style.transform = change));
  resting = setTimeout(placeView, 160);
}

// What a view box shows in a window: its upper left corner and the size of a pixel, centred as SVG does.
function framed([left, top, width, height], across, down) {
  const pixel = Math.max(width / across, height / down);
  return { pixel, left: left - 0.5 * (across * pixel - width), top: top - 0.5 * (down * pixel - height) };
}

// Where a pointer is on the sheet.
function place(event) {
  const box = byId("stage").getBoundingClientRect();
  const frame = framed(view, byId("stage").clientWidth, byId("stage").clientHeight);
  return [frame.left + (event.clientX - box.left) * frame.pixel, frame.top + (event.clientY - box.top) * frame.pixel];
}

function zoom(factor, about = [view[0] + 0.5 * view[2], view[1] + 0.5 * view[3]]) {
  const width = Math.min(Math.max(view[2] * factor, SHEET.view[2] / 2000), SHEET.view[2] * 4);
  const by = width / view[2];
  view = [about[0] + (view[0] - about[0]) * by, about[1] + (view[1] - about[1]) * by, view[2] * by, view[3] * by];
  viewChanged();
}

function move(across, down) {
  view = [view[0] + across, view[1] + down, view[2], view[3]];
  viewChanged();
}

function fitView() {
  view = SHEET.view.slice();
  viewChanged();
}

function gestures() {
  const pointers = new Map();
  let travelled = 0;
  drawing.addEventListener("pointerdown", (event) => {
    drawing.setPointerCapture(event.pointerId);
    if (pointers.size === 0) travelled = 0;
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    drawing.classList.add("moving");
  });
  drawing.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    travelled += Math.hypot(now[0] - before[0], now[1] - before[1]);
    const others = [...pointers].filter(([id]) => id !== event.pointerId);
    pointers.set(event.pointerId, now);
    if (others.length === 0) {
      if (travelled > 4) move((before[0] - now[0]) * scale(), (before[1] - now[1]) * scale());
    } else {
      const other = others[0][1];
      const apart = (point) => Math.max(Math.hypot(point[0] - other[0], point[1] - other[1]), 1);
      zoom(apart(before) / apart(now), place({ clientX: 0.5 * (now[0] + other[0]), clientY: 0.5 * (now[1] + other[1]) }));
    }
  });
  const end = (event) => {
    if (!pointers.delete(event.pointerId)) return;
    drawing.classList.remove("moving");
    if (event.type === "pointerup" && travelled <= 4) pickNear(place(event));
  };
  drawing.addEventListener("pointerup", end);
  drawing.addEventListener("pointercancel", end);
  drawing.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey && document.activeElement !== drawing) return;
    event.preventDefault();
    zoom(Math.exp(Math.max(-0.5, Math.min(0.5, event.deltaY * 0.0018))), place(event));
  }, { passive: false });
}

function keys() {
  const step = () => 0.12 * view[2];
  const actions = {
    ArrowLeft: () => move(-step(), 0), ArrowRight: () => move(step(), 0), ArrowUp: () => move(0, -step()),
    ArrowDown: () => move(0, step()), "+": () => zoom(0.6), "=": () => zoom(0.6), "-": () => zoom(1 / 0.6), 0: fitView,
  };
  drawing.addEventListener("keydown", (event) => {
    const action = actions[event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action();
  });
}

function pickNear([x, y]) {
  let [best, nearest] = [null, (24 * scale()) ** 2];
  for (let id = 0; id < COUNT; id += 1) {
    const [hx, hy] = at(id);
    const distance = (hx - x) ** 2 + (hy - y) ** 2;
    if (distance < nearest) [best, nearest] = [id, distance];
  }
  if (best !== null) pick(best, "sheet");
}

function ringPick(id, from) {
  const [x, y] = at(id);
  const ring = byId("pick");
  ring.setAttribute("cx", x);
  ring.setAttribute("cy", y);
  ring.setAttribute("visibility", "visible");
  ring.dataset.hinge = id;
  if (from === "sheet") return;
  const inside = x > view[0] && y > view[1] && x < view[0] + view[2] && y < view[1] + view[3];
  if (!inside) {
    view = [x - 0.5 * view[2], y - 0.5 * view[3], view[2], view[3]];
    viewChanged();
  }
}
