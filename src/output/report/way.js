// The way between the states in figures: what each step of it has, as curves, and where the view stands on them.

const WAY = DATA.space?.way ?? null;

// The value of a list with one number per step at a moment.
function alongWay(values, moment) {
  const times = WAY.at;
  let step = 0;
  while (step < times.length - 2 && times[step + 1] < moment) step += 1;
  const part = Math.min(Math.max((moment - times[step]) / (times[step + 1] - times[step]), 0), 1);
  return values[step] + part * (values[step + 1] - values[step]);
}

const degrees = (value) => `${fixed(value, value < 10 ? 1 : 0)}\u00b0`;

// What is to be said of a moment. Of two states alone only their angles are known.
function wayWords(moment) {
  if (!WAY) return [`largest hinge angle ${degrees(moment * extremes(HINGES.angle)[1])}`];
  const words = [`largest hinge angle ${degrees(alongWay(WAY.angle_max, moment))}`, `area ${fixed(alongWay(WAY.area, moment), 2)} times the closed one`];
  words.push(`path strain ${percent(alongWay(WAY.strain, moment))}`);
  if (alongWay(WAY.clashes, moment) > 0.5) words.push("pieces run into each other");
  return words;
}

// Curves over the way, with a band between two of them where `band` tells which.
function wayChart({ title, unit, values, band, digits: decimals, remark = "" }) {
  const all = [values, ...(band ?? [])].flat();
  const [least, most] = extremes(all);
  const [low, high] = [Math.min(least, 0 <= least && least < 0.5 * most ? 0 : least), most];
  const room = Math.max(high - low, 10 ** -decimals);
  const { width, height, left, right, top, bottom } = BOX;
  const x = (at) => left + at * (width - left - right);
  const y = (value) => height - bottom - ((value - low) / room) * (height - top - bottom);
  const path = (list, from = "M") => list.map((value, i) => `${i ? "L" : from}${fixed(x(WAY.at[i]), 2)} ${fixed(y(value), 2)}`).join("");
  const peak = values.indexOf(extremes(values)[1]);
  const inside = peak > 0 && peak < values.length - 1;
  const words = (inside ? `largest ${fixed(values[peak], decimals)}${unit} at ${fixed(100 * WAY.at[peak], 0)} % of the turn`
    : `closed ${fixed(values[0], decimals)}${unit}, open ${fixed(values[values.length - 1], decimals)}${unit}`) + remark;
  const svg = drawn("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${title} on the way: ${words}`, class: "way" });
  const tick = roundStep(room, 5);
  for (let value = Math.ceil(low / tick - 1e-9) * tick; value <= low + room + 1e-9 * tick; value += tick) {
    svg.append(line([left, y(value)], [width - right, y(value)], { class: "axis" }));
    svg.append(note(left - 5, y(value) + 4, fixed(value, Math.max(0, -Math.floor(Math.log10(tick) + 1e-9))), "end"));
  }
  for (const at of [0, 0.25, 0.5, 0.75, 1]) svg.append(note(x(at), height - bottom + 14, `${100 * at}`));
  svg.append(note(0.5 * (left + width - right), height - 4, "% of the turn from closed to open"));
  if (band) {
    const back = band[1].map((value, i) => `L${fixed(x(WAY.at[i]), 2)} ${fixed(y(value), 2)}`).reverse().join("");
    svg.append(drawn("path", { class: "band", d: `${path(band[0])}${back}Z` }));
  }
  svg.append(drawn("path", { class: "curve", d: path(values) }));
  WAY.clashes.forEach((clashes, i) => {
    if (clashes) svg.append(drawn("circle", { class: "clash", cx: x(WAY.at[i]), cy: height - bottom, r: 3.5 }));
  });
  svg.append(line([0, top], [0, height - bottom], { class: "here", "data-left": left, "data-span": width - left - right }));
  return figureOf(title, svg, words);
}

function drawWay() {
  byId("way").hidden = !WAY;
  byId("way-words").hidden = !WAY;
  byId("way-missing").hidden = WAY !== null;
  if (!WAY) return;
  const hundred = (list) => list.map((value) => 100 * value);
  byId("way").append(
    wayChart({ title: "Hinge angles", unit: "\u00b0", remark: "; the mean, in the band of least and largest", values: WAY.angle_mean, band: [WAY.angle_min, WAY.angle_max], digits: 1 }),
    wayChart({ title: "Area", unit: "", remark: "; times that of the closed sheet", values: WAY.area, digits: 3 }),
    wayChart({ title: "Path strain", unit: " %", remark: "; how far hinge points would part, of an edge", values: hundred(WAY.strain), digits: 3 }));
  byId("way-words").append(...WAY.words.map((text) => element("li", {}, text)));
}

function markWay(moment) {
  document.querySelectorAll("#way .here").forEach((mark) => {
    const at = Number(mark.dataset.left) + moment * Number(mark.dataset.span);
    mark.setAttribute("x1", at);
    mark.setAttribute("x2", at);
  });
}

// Where the target asks for how much stretch: a drawing of the program's own.
function showMap() {
  byId("map").hidden = DATA.map === null;
  if (DATA.map !== null) byId("map-picture").src = `data:image/svg+xml,${encodeURIComponent(DATA.map)}`;
}
