// The hinge table: only the rows in sight exist, so that tens of thousands stay smooth.

const ROW = 26;
// What is printed: the first rows in the order shown.
const PRINTED = 60;
const VERDICTS = ["ok", "warn", "fail"];

// Heading, width in per cent, the value to sort by, its text, and the first direction (-1: largest first).
const COLUMNS = [
  { name: "hinge", share: 5.5, value: (id) => id, text: String, first: 1 },
  { name: "pieces", share: 8, value: (id) => HINGES.piece_j[id] * 1e7 + HINGES.piece_k[id], text: (id) => `${HINGES.piece_j[id]} ${HINGES.piece_k[id]}`, first: 1 },
  { name: "verdict", share: 7, value: (id) => VERDICTS.indexOf(word("verdict", id)), text: (id) => word("verdict", id), first: -1, kind: "verdict" },
  { name: "strain %", share: 7.5, value: (id) => shown.loads.strain[id], text: (id) => fixed(100 * shown.loads.strain[id], 2), first: -1 },
  { name: "class", share: 13, value: (id) => shown.loads.class[id], text: (id) => CLASSES[shown.loads.class[id]], first: -1, kind: "class" },
  { name: "angle", share: 6.5, value: (id) => HINGES.angle[id], text: (id) => fixed(HINGES.angle[id], 1), first: -1 },
  { name: "tilt", share: 5.5, value: (id) => HINGES.tilt[id], text: (id) => fixed(HINGES.tilt[id], 1), first: -1 },
  { name: "width", share: 6.5, value: (id) => HINGES.width[id], text: (id) => fixed(HINGES.width[id], 3), first: 1 },
  { name: "length", share: 6.5, value: (id) => HINGES.length[id], text: (id) => fixed(HINGES.length[id], 2), first: -1 },
  { name: "torque", share: 7, value: (id) => shown.loads.torque[id] ?? -1, text: (id) => (shown.loads.torque[id] === null ? "\u2013" : digits(shown.loads.torque[id])), first: -1 },
  { name: "next cut", share: 7.5, value: (id) => HINGES.next[id] ?? Infinity, text: (id) => fixed(HINGES.next[id], 2), first: 1 },
  { name: "reason", share: 19, value: (id) => word("reason", id), text: (id) => word("reason", id), first: 1, kind: "reason" },
];

const table = { order: [], sort: null, sense: 1, active: 0 };

function buildTable() {
  const head = byId("table").tHead.rows[0];
  COLUMNS.forEach((column, index) => {
    const button = element("button", { type: "button", onclick: () => sortBy(index) }, column.name);
    head.append(element("th", { scope: "col", style: `width: ${column.share}%`, class: column.kind ? "" : "number", "data-name": column.name }, button));
  });
  for (const [id, names] of [["by-verdict", VERDICTS], ["by-class", CLASSES]]) {
    byId(id).append(...names.map((name) => element("option", { value: name }, name)));
    byId(id).addEventListener("change", refill);
  }
  byId("search").addEventListener("input", refill);
  byId("scroller").addEventListener("scroll", fillRows);
  const body = byId("table").tBodies[0];
  body.addEventListener("click", (event) => choose(rowOf(event)));
  body.addEventListener("keydown", walk);
  window.addEventListener("beforeprint", printRows);
  window.addEventListener("afterprint", fillRows);
  onLoads.push(refill);
  onPick.push(showPicked);
  refill();
}

// Worst first: by verdict, then strain, then id, as in the terminal.
function worse(a, b) {
  return COLUMNS[2].value(b) - COLUMNS[2].value(a) || shown.loads.strain[b] - shown.loads.strain[a] || a - b;
}

function matches(id) {
  const [verdict, kind] = [byId("by-verdict").value, byId("by-class").value];
  if (verdict && word("verdict", id) !== verdict) return false;
  if (kind && CLASSES[shown.loads.class[id]] !== kind) return false;
  const wanted = byId("search").value.trim().toLowerCase();
  if (wanted === "") return true;
  if (/^#?\d+$/.test(wanted)) return id === Number(wanted.replace("#", ""));
  const piece = /^pieces?\s+(\d+)$/.exec(wanted);
  if (piece) return [HINGES.piece_j[id], HINGES.piece_k[id]].includes(Number(piece[1]));
  const words = [word("verdict", id), CLASSES[shown.loads.class[id]], word("reason", id), shown.loads.fatigue[id]];
  return words.some((text) => text.toLowerCase().includes(wanted));
}

function refill() {
  const ids = allIds.filter(matches);
  if (table.sort === null) {
    ids.sort(worse);
  } else {
    const { value } = COLUMNS[table.sort];
    const keys = new Map(ids.map((id) => [id, value(id)]));
    const compare = (a, b) => (a < b ? -1 : a > b ? 1 : 0);
    ids.sort((a, b) => table.sense * compare(keys.get(a), keys.get(b)) || a - b);
  }
  table.order = ids;
  table.active = Math.max(ids.indexOf(picked), 0);
  byId("table").setAttribute("aria-rowcount", ids.length + 1);
  byId("count").textContent = `${ids.length} of ${COUNT} hinges`;
  byId("scroller").scrollTop = 0;
  fillRows();
}

function sortBy(index) {
  table.sense = table.sort === index ? -table.sense : COLUMNS[index].first;
  table.sort = index;
  [...byId("table").tHead.rows[0].cells].forEach((cell, i) => {
    if (i === index) cell.setAttribute("aria-sort", table.sense > 0 ? "ascending" : "descending");
    else cell.removeAttribute("aria-sort");
  });
  refill();
}

function row(position) {
  const id = table.order[position];
  const attributes = { "data-id": id, "aria-rowindex": position + 2, tabindex: position === table.active ? 0 : -1 };
  if (id === picked) Object.assign(attributes, { class: "picked", "aria-current": "true" });
  const cell = (column) => {
    const text = column.text(id);
    if (column.kind === "verdict") return element("td", { class: text }, text);
    if (column.kind === "class") {
      const colour = `background: var(--class-${shown.loads.class[id]})`;
      return element("td", {}, element("span", { class: "swatch", style: colour }), text);
    }
    return element("td", { class: column.kind ?? "number", title: column.kind ? text : "" }, text);
  };
  return element("tr", attributes, ...COLUMNS.map(cell));
}

function gap(rows) {
  const cell = element("td", { colspan: COLUMNS.length, style: `height: ${rows * ROW}px` });
  return element("tr", { class: "gap", "aria-hidden": "true" }, cell);
}

function fillRows() {
  const scroller = byId("scroller");
  const from = Math.max(Math.floor(scroller.scrollTop / ROW) - 8, 0);
  const to = Math.min(from + Math.ceil(scroller.clientHeight / ROW) + 18, table.order.length);
  const body = byId("table").tBodies[0];
  const focused = body.contains(document.activeElement);
  const rows = [];
  for (let position = from; position < to; position += 1) rows.push(row(position));
  body.replaceChildren(...(from > 0 ? [gap(from)] : []), ...rows,
    ...(to < table.order.length ? [gap(table.order.length - to)] : []));
  if (focused) body.querySelector('tr[tabindex="0"]')?.focus({ preventScroll: true });
}

function printRows() {
  const count = Math.min(PRINTED, table.order.length);
  byId("table").tBodies[0].replaceChildren(...Array.from({ length: count }, (_, position) => row(position)));
  byId("print-note").textContent = `${count} of ${COUNT} hinges; all of them are in hinges.csv.`;
}

const rowOf = (event) => event.target.closest("tr[data-id]");

function choose(line) {
  if (!line) return;
  table.active = Number(line.getAttribute("aria-rowindex")) - 2;
  pick(Number(line.dataset.id), "table");
}

function walk(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const page = Math.max(Math.floor(byId("scroller").clientHeight / ROW) - 2, 1);
  const last = table.order.length - 1;
  const targets = {
    ArrowDown: table.active + 1, ArrowUp: table.active - 1, PageDown: table.active + page,
    PageUp: table.active - page, Home: 0, End: last,
  };
  if (event.key === "Enter" || event.key === " ") {
    event.preventDefault();
    choose(rowOf(event));
  } else if (event.key in targets) {
    event.preventDefault();
    reach(Math.min(Math.max(targets[event.key], 0), last));
    byId("table").tBodies[0].querySelector('tr[tabindex="0"]')?.focus({ preventScroll: true });
  }
}

// Makes a row the one that the keyboard is at, and brings it into sight.
function reach(position) {
  table.active = position;
  const scroller = byId("scroller");
  // The heading covers the first row's height of what is in sight.
  const [top, room] = [position * ROW, scroller.clientHeight - 2 * ROW];
  if (top < scroller.scrollTop) scroller.scrollTop = top;
  else if (top > scroller.scrollTop + room) scroller.scrollTop = top - room;
  fillRows();
}

function showPicked(id, from) {
  const position = table.order.indexOf(id);
  if (from !== "table" && position >= 0) reach(position);
  else fillRows();
}
