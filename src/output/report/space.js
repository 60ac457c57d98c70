// The pieces in space as the data tell them: outlines, where each piece is at a moment, and its hinges. Nothing is drawn here.
// Frame: that of the page (src/output/report/space.rs), millimetres, z up.

const SPACE = DATA.space;
// Numbers of a pose in the data: place, then quaternion. Numbers per piece for the drawing: quaternion and 0, place and 0, colour.
const [POSE, SLOT] = [7, 12];

function bytesOf(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i += 1) bytes[i] = letters.charCodeAt(i);
  return bytes.buffer;
}

function readSpace() {
  const counts = new Uint16Array(bytesOf(SPACE.counts));
  const corners = Float32Array.from(new Int16Array(bytesOf(SPACE.outlines)), (whole) => whole * SPACE.outline_unit);
  const poses = new Int16Array(bytesOf(SPACE.poses));
  const starts = new Uint32Array(counts.length + 1);
  counts.forEach((count, piece) => (starts[piece + 1] = starts[piece] + count));
  const read = { count: counts.length, corners, starts, poses, now: new Float32Array(SLOT * counts.length) };
  // How far the corners of each piece reach from its middle.
  read.reach = Float32Array.from(counts, (count, piece) => {
    let most = 0;
    for (let i = starts[piece]; i < starts[piece + 1]; i += 1) most = Math.max(most, Math.hypot(corners[2 * i], corners[2 * i + 1]));
    return most;
  });
  read.size = read.reach.reduce((sum, reach) => sum + reach, 0) / read.count;
  return read;
}

// Fills `now` with the pieces' poses at a moment from 0 (closed) to 1 (open).
function poseSpace(read, moment) {
  const times = SPACE.at;
  let step = 0;
  while (step < times.length - 2 && times[step + 1] < moment) step += 1;
  const part = Math.min(Math.max((moment - times[step]) / (times[step + 1] - times[step]), 0), 1);
  for (let piece = 0; piece < read.count; piece += 1) posePiece(read, piece, step, part);
}

// Between two steps a piece's middle goes straight and its quaternion along the great circle; both lie on one side.
function posePiece({ poses, now, count }, piece, step, part) {
  const [from, slot] = [POSE * (step * count + piece), SLOT * piece];
  const to = from + POSE * count;
  let cosine = 0;
  for (let i = 3; i < POSE; i += 1) cosine += poses[from + i] * poses[to + i];
  const angle = Math.acos(Math.min(cosine / 32767 ** 2, 1));
  const weights = angle < 1e-3 ? [1 - part, part] : [Math.sin((1 - part) * angle), Math.sin(part * angle)];
  let length = 0;
  for (let i = 0; i < 4; i += 1) {
    now[slot + i] = weights[0] * poses[from + 3 + i] + weights[1] * poses[to + 3 + i];
    length += now[slot + i] ** 2;
  }
  for (let i = 0; i < 4; i += 1) now[slot + i] /= Math.sqrt(length);
  for (let i = 0; i < 3; i += 1) now[slot + 4 + i] = ((1 - part) * poses[from + i] + part * poses[to + i]) * SPACE.place_unit;
}

// A vector turned by a piece's quaternion (back by its inverse where `sense` is -1).
function turned(now, piece, [x, y, z], sense = 1) {
  const slot = SLOT * piece;
  const [i, j, k, w] = [sense * now[slot], sense * now[slot + 1], sense * now[slot + 2], now[slot + 3]];
  const [a, b, c] = [j * z - k * y + w * x, k * x - i * z + w * y, i * y - j * x + w * z];
  return [x + 2 * (j * c - k * b), y + 2 * (k * a - i * c), z + 2 * (i * b - j * a)];
}

const placeOf = (now, piece) => [now[SLOT * piece + 4], now[SLOT * piece + 5], now[SLOT * piece + 6]];
const less = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const more = (a, b, times = 1) => [a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]];

// A point of a piece's own frame on the page.
const placed = (now, piece, point) => more(turned(now, piece, point), placeOf(now, piece));

// Every hinge's point and axis in the own frames of its two pieces.
function readHinges(read) {
  const { step, page } = SPACE.rest;
  for (let piece = 0; piece < read.count; piece += 1) posePiece(read, piece, Math.min(step, SPACE.at.length - 2), step > 0 ? 1 : 0);
  const line = (i, v, times) => page[4 * i] * v[0] + page[4 * i + 1] * v[1] + page[4 * i + 2] * v[2] + times * page[4 * i + 3];
  const onPage = (v, times) => [line(0, v, times), line(1, v, times), line(2, v, times)];
  return allIds.map((id) => {
    const point = onPage([HINGES.x[id], HINGES.y[id], HINGES.z[id]], 1);
    const axis = onPage([HINGES.axis_x[id], HINGES.axis_y[id], HINGES.axis_z[id]], 0);
    const pieces = [HINGES.piece_j[id], HINGES.piece_k[id]];
    const own = (piece) => ({
      point: turned(read.now, piece, less(point, placeOf(read.now, piece)), -1),
      axis: turned(read.now, piece, axis, -1),
    });
    return { pieces, own: pieces.map(own) };
  });
}

// Where a hinge is and how its axis points: the mean of what its two pieces say.
function hingeNow(read, { pieces, own }) {
  const ends = pieces.map((piece, i) => placed(read.now, piece, own[i].point));
  const axes = pieces.map((piece, i) => turned(read.now, piece, own[i].axis));
  const axis = more(axes[0], axes[1]);
  const length = Math.hypot(...axis);
  return { point: more(ends[0], less(ends[1], ends[0]), 0.5), axis: axis.map((c) => c / Math.max(length, 1e-9)) };
}

// The piece that a ray meets first at its mid-plane; null where there is none.
function pieceOnRay(read, from, along) {
  let [best, nearest] = [null, Infinity];
  for (let piece = 0; piece < read.count; piece += 1) {
    const own = turned(read.now, piece, less(from, placeOf(read.now, piece)), -1);
    const way = turned(read.now, piece, along, -1);
    const reach = -own[2] / way[2];
    if (!(reach < nearest) || !Number.isFinite(reach)) continue;
    const [x, y] = [own[0] + reach * way[0], own[1] + reach * way[1]];
    if (Math.hypot(x, y) <= read.reach[piece] && covers(read, piece, x, y)) [best, nearest] = [piece, reach];
  }
  return best;
}

function covers({ corners, starts }, piece, x, y) {
  let inside = false;
  for (let i = starts[piece], before = starts[piece + 1] - 1; i < starts[piece + 1]; before = i, i += 1) {
    const [ax, ay, bx, by] = [corners[2 * i], corners[2 * i + 1], corners[2 * before], corners[2 * before + 1]];
    if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) inside = !inside;
  }
  return inside;
}
