// Histograms of the hinges and the energies of the optimisation, as plain SVG.

// Steps of 1, 2 or 5 times a power of ten: at most `most` of them over the span.
function roundStep(span, most) {
  const raw = Math.max(span, 1e-12) / most;
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * ([1, 2, 5].find((factor) => factor * power >= raw * (1 - 1e-9)) ?? 10);
}

const BOX = { width: 360, height: 200, left: 44, right: 18, top: 8, bottom: 34 };

function line(from, to, attributes) {
  return drawn("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], ...attributes });
}

function note(x, y, text, anchor = "middle") {
  return drawn("text", { x, y, "text-anchor": anchor }, text);
}

function figureOf(title, svg, below) {
  return element("figure", {}, element("h3", {}, title), svg, element("figcaption", {}, below));
}

// `limits`: values to mark, with a word each; those outside of the values are left out.
function histogram({ title, values, unit, digits, limits = [] }) {
  const [least, most] = extremes(values);
  const step = roundStep(Math.max(most - least, 10 ** -digits), 24);
  const low = Math.floor(least / step + 1e-9) * step;
  const bins = Array(Math.max(Math.floor((most - low) / step + 1e-9) + 1, 1)).fill(0);
  for (const value of values) bins[Math.min(Math.floor((value - low) / step + 1e-9), bins.length - 1)] += 1;
  const tallest = Math.max(...bins);
  const high = low + bins.length * step;
  const { width, height, left, right, top, bottom } = BOX;
  const x = (value) => left + ((value - low) / (high - low)) * (width - left - right);
  const y = (count) => height - bottom - (count / tallest) * (height - top - bottom);
  const sorted = Float64Array.from(values).sort();
  const median = sorted[Math.floor(0.5 * (sorted.length - 1))];
  const words = `least ${fixed(least, digits)}, median ${fixed(median, digits)}, most ${fixed(most, digits)} ${unit}`;
  const svg = drawn("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${title}: ${words}` });
  bins.forEach((count, i) => {
    const [from, to] = [low + i * step, low + (i + 1) * step];
    const bar = drawn("rect", { x: x(from) + 0.5, y: y(count), width: Math.max(x(to) - x(from) - 1, 0.5),
      height: height - bottom - y(count), fill: "var(--bar)" });
    const range = `${fixed(from, digits)} to ${fixed(to, digits)} ${unit}`;
    bar.append(drawn("title", {}, `${range}: ${count} hinges`));
    svg.append(bar);
  });
  svg.append(line([left, height - bottom], [width - right, height - bottom], { class: "axis" }));
  const tick = roundStep(high - low, 6);
  for (let value = Math.ceil(low / tick - 1e-9) * tick; value <= high + 1e-9 * tick; value += tick) {
    svg.append(note(x(value), height - bottom + 14, fixed(value, Math.max(0, -Math.floor(Math.log10(tick) + 1e-9)))));
  }
  svg.append(note(left - 5, y(tallest) + 8, String(tallest), "end"), note(left - 5, height - bottom, "0", "end"));
  svg.append(note(0.5 * (left + width - right), height - 4, unit));
  for (const [value, name] of limits.filter(([value]) => value > low && value <= high)) {
    svg.append(line([x(value), top], [x(value), height - bottom], { class: "limit" }));
    svg.append(note(x(value) - 3, top + 10, name, "end"));
  }
  return figureOf(title, svg, words);
}

function drawHistograms() {
  const { yieldStrain, strainLimit, elongation } = shown.material;
  const limits = [[100 * yieldStrain, "yield"], [100 * strainLimit, "limit"], [100 * elongation, "break"]];
  const strains = shown.loads.strain.map((strain) => 100 * strain);
  byId("histograms").replaceChildren(...(COUNT === 0 ? [] : [
    histogram({ title: "Turning angle", values: HINGES.angle, unit: "degrees", digits: 1 }),
    histogram({ title: "Tilt of the axis", values: HINGES.tilt, unit: "degrees", digits: 2 }),
    histogram({ title: shown.altered ? "Strain, what if" : "Strain", values: strains, unit: "%", digits: 2, limits }),
  ]));
}

// Energies of one stage on a logarithmic scale; a phase begins at a dashed line.
function energyChart({ name, stopped, phases }) {
  const curves = new Map();
  const starts = [];
  let count = 0;
  for (const { terms, energies } of phases) {
    starts.push(count);
    energies.forEach((row) => {
      terms.forEach((term, i) => {
        if (row[i] > 0) curves.set(term, [...(curves.get(term) ?? []), [count, Math.log10(row[i])]]);
      });
      count += 1;
    });
  }
  const values = [...curves.values()].flat().map(([, value]) => value);
  if (values.length === 0) return null;
  const [least, most] = extremes(values);
  const [low, high] = [Math.floor(least), Math.max(Math.ceil(most), Math.floor(least) + 1)];
  const { left, right, top, bottom } = BOX;
  const [width, height] = [520, 280];
  const x = (step) => left + (step / Math.max(count - 1, 1)) * (width - left - right);
  const y = (value) => height - bottom - ((value - low) / (high - low)) * (height - top - bottom);
  const words = `${count} rows over ${phases.length} phases; ended: ${stopped}`;
  const svg = drawn("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `Energies of ${name}: ${words}` });
  const tick = Math.max(Math.ceil((high - low) / 7), 1);
  for (let power = low; power <= high; power += tick) {
    svg.append(line([left, y(power)], [width - right, y(power)], { class: "axis" }));
    svg.append(note(left - 5, y(power) + 4, `1e${power}`, "end"));
  }
  starts.slice(1).forEach((start) =>
    svg.append(line([x(start), top], [x(start), height - bottom], { class: "axis", "stroke-dasharray": "3 3" })));
  const across = Math.max(roundStep(Math.max(count - 1, 1), 8), 1);
  for (let step = 0; step < count; step += across) svg.append(note(x(step), height - bottom + 14, String(step)));
  svg.append(note(0.5 * (left + width - right), height - 4, "iteration"));
  const legend = element("span");
  [...curves].forEach(([term, points], i) => {
    const colour = `var(--curve-${i % 6})`;
    const data = points.map(([step, value], k) => `${k && points[k - 1][0] === step - 1 ? "L" : "M"}${fixed(x(step), 2)} ${fixed(y(value), 2)}`);
    const dash = i >= 6 ? "5 3" : "none";
    svg.append(drawn("path", { d: data.join("") + (points.length === 1 ? "h1" : ""), fill: "none", stroke: colour, "stroke-width": 1.8, "stroke-dasharray": dash }));
    legend.append(element("span", { class: "swatch", style: `background: ${colour}` }), `${term}${i >= 6 ? " (dashed)" : ""}  `);
  });
  return figureOf(name, svg, legend.childElementCount > 0 ? element("span", {}, legend, element("br"), words) : words);
}

function drawStages() {
  const charts = DATA.stages.map(energyChart).filter((chart) => chart !== null);
  byId("stages").append(...charts);
  if (charts.length === 0) byId("stages").append(element("p", { class: "note" }, "No iterations were recorded."));
}
