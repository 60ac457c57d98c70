// What all parts share: the data, elements, numbers as text; and the parts that are text alone.

const DATA = JSON.parse(document.getElementById("data").textContent);
const SVG = "http://www.w3.org/2000/svg";
const byId = (id) => document.getElementById(id);

// An element with attributes and children; texts are text nodes, never markup.
function element(name, attributes = {}, ...children) {
  return filled(document.createElement(name), attributes, children);
}

function drawn(name, attributes = {}, ...children) {
  return filled(document.createElementNS(SVG, name), attributes, children);
}

function filled(node, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else node.setAttribute(key, value);
  }
  node.append(...children.filter((child) => child !== null));
  return node;
}

// Fixed decimals without a negative zero; a dash where there is no number.
function fixed(value, digits) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "\u2013";
  const text = value.toFixed(digits);
  return /^-0(\.0*)?$/.test(text) ? text.slice(1) : text;
}

// Three digits that count.
const digits = (value) => (value === 0 ? "0" : value < 1e-3 ? value.toExponential(1) : Number(value.toPrecision(3)).toString());
const percent = (value) => `${fixed(100 * value, 2)} %`;
const radians = (degrees) => (degrees * Math.PI) / 180;

function extremes(values) {
  let [least, most] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < least) least = value;
    if (value > most) most = value;
  }
  return [least, most];
}

// The hinges, column by column; `count` of them. A column holds plain values, or indices into `DATA.words`.
const HINGES = DATA.hinges;
const COUNT = HINGES.piece_j.length;
const word = (column, id) => DATA.words[column][HINGES[column][id]];

// What tables, drawings and charts show: as made, or what the reader asks for. Views register with `onLoads`.
// `mechanics` and `material` are what they were computed with.
const shown = { loads: null, altered: false, mechanics: DATA.mechanics, material: DATA.materials[0] };
const onLoads = [];

function loadsAsMade() {
  return {
    strain: HINGES.strain, class: HINGES.class, torque: HINGES.torque, length: HINGES.length,
    fatigue: HINGES.fatigue.map((index) => DATA.words.fatigue[index]),
  };
}

function showLoads(loads, altered) {
  shown.loads = loads;
  shown.altered = altered;
  onLoads.forEach((view) => view());
}

// The chosen hinge; views register with `onPick`.
const onPick = [];
let picked = null;

function pick(id, from) {
  picked = id;
  onPick.forEach((view) => view(id, from));
}

function textParts() {
  byId("job").textContent = DATA.job;
  const parts = [`target ${DATA.target}`, `profile ${DATA.profile}`, DATA.material, DATA.process];
  byId("source").textContent = parts.join("  \u00b7  ");
  const verdict = byId("verdict");
  verdict.className = DATA.verdict.level;
  verdict.append(`${DATA.job}: ${DATA.verdict.text}`);
  if (DATA.verdict.hinges) verdict.append(element("span", {}, DATA.verdict.hinges));
  byId("program").textContent = `Made by ${DATA.program}. Lengths in millimetres, angles in degrees.`;
  const row = ([label, value]) =>
    element("tr", {}, element("th", { scope: "row" }, label), element("td", {}, value));
  byId("summary").tBodies[0].append(...DATA.figures.map(row));
  byId("limits").tBodies[0].append(...DATA.limits.map(limitRow));
  if (DATA.snap) {
    byId("snap").hidden = false;
    byId("snap").tBodies[0].append(...DATA.snap.map(row));
  }
  byId("remarks").append(...DATA.remarks.map((text) => element("li", {}, text)));
  const step = ({ title, text }) => element("li", {}, element("strong", {}, title), ` ${text}`);
  byId("steps").append(...DATA.steps.map(step));
  byId("cutting").hidden = DATA.cut.length === 0;
  byId("cut").tBodies[0].append(...DATA.cut.map(row));
  byId("cut-lines").append(...DATA.cut_lines.map((text) => element("li", {}, text)));
  byId("setup").hidden = DATA.setup.length === 0;
  byId("setup").tBodies[0].append(...DATA.setup.map(row));
  byId("restarts").hidden = DATA.restarts.length === 0;
  byId("restarts").lastElementChild.textContent = DATA.restarts.join("\n");
}

function limitRow({ what, value, limit, kept }) {
  const state = kept ? ["ok", "yes"] : ["fail", "no"];
  return element("tr", {}, element("th", { scope: "row" }, what), element("td", {}, value), element("td", {}, limit),
    element("td", { class: state[0] }, state[1]));
}

function themeButton() {
  const names = { "": "system", light: "light", dark: "dark" };
  const order = ["", "light", "dark"];
  const button = byId("theme");
  let now = 0;
  button.addEventListener("click", () => {
    now = (now + 1) % order.length;
    document.documentElement.dataset.theme = order[now];
    button.textContent = `Colours: ${names[order[now]]}`;
    button.setAttribute("aria-label", `Colours: ${names[order[now]] === "system" ? "as the system" : names[order[now]]}`);
  });
}
