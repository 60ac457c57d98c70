// One ligament, enlarged as it is cut, with its dimensions, and all that is known of its hinge.

function showDetail(id) {
  byId("detail-title").textContent = `Hinge ${id}, between pieces ${HINGES.piece_j[id]} and ${HINGES.piece_k[id]}`;
  const load = (key) => shown.loads[key][id];
  const torque = load("torque");
  const facts = [
    ["turns by", `${fixed(HINGES.angle[id], 2)}\u00b0`],
    ["ligament", `${fixed(HINGES.width[id], 3)} \u00d7 ${fixed(HINGES.length[id], 3)} mm, sheet ${DATA.mechanics.thickness} mm`],
    ["strain", `${percent(load("strain"))}, ${CLASSES[load("class")]}`],
    ["torque", torque === null ? "above yield: none follows" : `${digits(torque)} N mm`],
    ["stiffness", `${digits(stiffness(shown.mechanics, elasticLength(shown.mechanics, load("length"))))} N mm per radian, elastic`],
    ["lasts", load("fatigue")],
    ["lets go", `${fixed(turnsBack(id), 2)}\u00b0 back when released`],
    ["axis", `tilts ${fixed(HINGES.tilt[id], 2)}\u00b0; (${["axis_x", "axis_y", "axis_z"].map((key) => fixed(HINGES[key][id], 4)).join(", ")})`],
    ["point", `(${["x", "y", "z"].map((key) => fixed(HINGES[key][id], 3)).join(", ")}) mm`],
    ["centre", `${fixed(HINGES.centre[id], 4)} mm off its place`],
    ["next cut", HINGES.next[id] === null ? "none near" : `${fixed(HINGES.next[id], 3)} mm`],
    ["web margin", `${fixed(HINGES.web[id], 3)} mm over the least web`],
    [shown.altered ? "as made" : "verdict", word("verdict", id) + (word("reason", id) ? `: ${word("reason", id)}` : "")],
  ];
  if (HINGES.pole[id] !== 0) facts.splice(9, 0, ["pole", `${fixed(HINGES.pole[id], 4)} mm from the ligament's centre`]);
  if (shown.altered) facts.splice(2, 0, ["what if", `${fixed(shown.mechanics.width, 3)} \u00d7 ${fixed(load("length"), 3)} mm, sheet ${shown.mechanics.thickness} mm`]);
  byId("detail-values").replaceChildren(...facts.flatMap(([name, value]) =>
    [element("dt", {}, name), element("dd", {}, value)]));
  drawLigament(id);
}

function turnsBack(id) {
  return (springback(shown.mechanics, shown.loads.length[id], radians(HINGES.angle[id])) * 180) / Math.PI;
}

// The ligament lies level, the groove that frees it above, the one that passes below.
function drawLigament(id) {
  const [width, length, groove] = [HINGES.width[id], HINGES.length[id], SHEET.kerf];
  const half = 1.25 * Math.max(0.5 * length + width + groove, 0.05);
  const unit = (2 * half) / 100;
  const svg = byId("ligament");
  svg.setAttribute("viewBox", [-half, -half, 2 * half, 2 * half].map((value) => fixed(value, 4)).join(" "));
  svg.setAttribute("aria-label", `Ligament of hinge ${id}: ${fixed(width, 3)} mm wide, ${fixed(length, 3)} mm long, ` +
    `beside grooves of ${groove} mm; it turns by ${fixed(HINGES.angle[id], 1)} degrees`);
  const shift = -HINGES.pole[id];
  const beam = [-0.5 * length, shift - 0.5 * width, length, width];
  const rectangle = drawn("rect", { class: "beam", x: beam[0], y: beam[1], width: length, height: width });
  const [px, py] = at(id);
  const turned = drawn("g", { transform: `rotate(${fixed(HINGES.direction[id], 4)}) translate(${-px} ${-py})` });
  for (const layer of SHEET.layers) {
    const cut = layer.class.startsWith("cut-");
    const style = cut ? { class: "groove", "stroke-width": groove } : { class: layer.class };
    turned.append(drawn("use", { href: `#shape-${layer.id}`, ...style }));
  }
  const right = Math.min(beam[0] + length + 9 * unit, half - 12 * unit);
  const below = beam[1] + width + Math.max(10 * unit, groove + 4 * unit);
  svg.replaceChildren(turned, rectangle,
    size([beam[0], below], [beam[0] + length, below], `${fixed(length, 3)}`, unit),
    size([right, beam[1]], [right, beam[1] + width], `${fixed(width, 3)}`, unit),
    drawn("circle", { class: "head", cx: 0, cy: 0, r: 1.1 * unit }),
    label([-half + 2 * unit, half - 2.5 * unit], caption(id), unit, "start"));
}

function caption(id) {
  const turned = Math.round(HINGES.direction[id]);
  const direction = turned === 0 || !SHEET.laid_out ? "" : `, turned by ${-turned}\u00b0`;
  return SHEET.laid_out ? `mm; dot: hinge point${direction}` : "mm; not laid out: no flat state";
}

function label([x, y], text, unit, anchor) {
  const attributes = { x, y, "text-anchor": anchor, "font-size": 5 * unit, "stroke-width": 1.4 * unit };
  return drawn("text", attributes, text);
}

// A dimension line with heads at its ends (from outside where they are near) and its label.
function size(from, to, text, unit) {
  const span = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const along = [(to[0] - from[0]) / span, (to[1] - from[1]) / span];
  const inside = span > 14 * unit;
  const reach = inside ? 0 : 7 * unit;
  const point = (base, t, s = 0) => `${base[0] + along[0] * t - along[1] * s} ${base[1] + along[1] * t + along[0] * s}`;
  const head = (tip, sense) => drawn("path", { class: "head",
    d: `M${point(tip, 0)}L${point(tip, sense * 3 * unit, unit)}L${point(tip, sense * 3 * unit, -unit)}Z` });
  const line = inside ? `M${point(from, 0)}L${point(to, 0)}`
    : `M${point(from, -reach)}L${point(from, 0)}M${point(to, 0)}L${point(to, reach)}`;
  const level = Math.abs(along[0]) > 0.5;
  const middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
  const where = level ? [middle[0], middle[1] + 6.5 * unit] : [middle[0] + 2.5 * unit, middle[1] + 1.7 * unit];
  return drawn("g", {}, drawn("path", { class: "size", d: line, "stroke-width": 0.5 * unit }),
    head(from, inside ? 1 : -1), head(to, inside ? -1 : 1), label(where, text, unit, level ? "middle" : "start"));
}
