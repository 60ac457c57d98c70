// A report of many copies of a small one's pieces and hinges, side by side. Arguments: report.html, least number of hinges,
// where the large page goes. Prints the number of hinges as JSON.
"use strict";
const fs = require("fs");

const [, , from, least, to] = process.argv;
const page = fs.readFileSync(from, "utf8");
const start = '<script type="application/json" id="data">';
const [head, rest] = page.split(start);
const end = rest.indexOf("</script>");
const data = JSON.parse(rest.slice(0, end));

const { hinges, space } = data;
const small = { hinges: hinges.x.length, pieces: space.senses.length };
const copies = Array.from({ length: Math.ceil(Number(least) / small.hinges) }, (_, copy) => [130 * (copy % 9), 130 * Math.floor(copy / 9), copy]);
const many = (column, moved) => copies.flatMap((place) => column.map((value) => moved(value, place)));
for (const [name, column] of Object.entries(hinges)) {
  const by = { x: (value, [x]) => value + x, y: (value, [, y]) => value + y };
  const piece = (value, [, , copy]) => value + copy * small.pieces;
  hinges[name] = many(column, name.startsWith("piece") ? piece : by[name] ?? ((value) => value));
}
const [width, height] = [1170, 130 * Math.ceil(copies.length / 9)];
data.sheet.view = [0, -height, width, height];

const words = (text) => { const bytes = Buffer.from(text, "base64"); return new Int16Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length)); };
const text = (numbers) => Buffer.from(Int16Array.from(numbers).buffer).toString("base64");
const again = (column) => many([...column], (value) => value);
space.counts = text(again(words(space.counts)));
space.outlines = text(again(words(space.outlines)));
space.senses = again(space.senses);
if (space.distance) space.distance = again(space.distance);
const poses = words(space.poses);
const unit = (Math.max(width, height) + space.place_unit * 32767) / 32767;
const moved = [];
for (let step = 0; step < space.at.length; step += 1) {
  for (const [x, y] of copies) {
    for (let piece = 0; piece < small.pieces; piece += 1) {
      const pose = [...poses.subarray(7 * (step * small.pieces + piece), 7 * (step * small.pieces + piece + 1))];
      [0, 1, 2].forEach((i) => (pose[i] = Math.round((pose[i] * space.place_unit + [x, y, 0][i]) / unit)));
      moved.push(...pose);
    }
  }
}
Object.assign(space, { poses: text(moved), place_unit: unit, targets: [] });
fs.writeFileSync(to, `${head}${start}${JSON.stringify(data)}${rest.slice(end)}`);
process.stdout.write(`${JSON.stringify(hinges.x.length)}\n`);
