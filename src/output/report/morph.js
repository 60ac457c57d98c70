// The sheet in space: from one state to the other by slider, keys or by itself, coloured, and picked in.

const morph = { moment: 1, playing: 0, read: null };
const inSpace = byId("space-canvas");
const slider = byId("space-slider");
const calm = matchMedia("(prefers-reduced-motion: reduce)");

// Colours of the style sheet as the page shows them now, red, green and blue up to 1.
function styleColour(name) {
  const probe = byId("space-probe");
  probe.style.color = `var(--${name})`;
  return getComputedStyle(probe).color.match(/[\d.]+/g).slice(0, 3).map((part) => Number(part) / 255);
}

const blend = (a, b, part) => a.map((c, i) => c + part * (b[i] - c));

// What pieces can be coloured by: the words, one value per piece, the colour of a value, and the legend's entries.
function colourings() {
  const ways = [{
    words: "turning sense", of: () => SPACE.senses, colour: (sense) => styleColour(["solid-a", "solid-b", "solid-c"][sense]),
    legend: (found) => [["counter-clockwise", "solid-a", 0], ["clockwise", "solid-b", 1], ["does not turn", "solid-c", 2]]
      .filter(([, , sense]) => found.includes(sense)).map(([name, colour]) => [name, `var(--${colour})`]),
  }, {
    words: "worst strain class", of: worstClasses, colour: (kind) => (kind < 0 ? styleColour("solid-c") : styleColour(`class-${kind}`)),
    legend: (found) => CLASSES.map((name, kind) => [name, `var(--class-${kind})`, kind]).filter(([, , kind]) => found.includes(kind)),
  }];
  if (SPACE.distance) {
    const most = Math.max(...SPACE.distance, 1e-6);
    const colour = (off) => blend(styleColour("near"), styleColour("far"), off / most);
    ways.push({
      words: "distance to target", of: () => SPACE.distance, colour,
      legend: () => [["on the target", "var(--near)"], [`${digits(most)} mm off`, "var(--far)"]],
    });
  }
  return ways;
}

// The worst strain class of each piece's hinges; -1 without.
function worstClasses() {
  const worst = Array(morph.read.count).fill(-1);
  for (const id of allIds) {
    for (const piece of [HINGES.piece_j[id], HINGES.piece_k[id]]) worst[piece] = Math.max(worst[piece], shown.loads.class[id]);
  }
  return worst;
}

function tintPieces() {
  const way = morph.ways[byId("space-colour").value];
  const values = way.of();
  const known = new Map();
  const chosen = picked === null ? [] : [HINGES.piece_j[picked], HINGES.piece_k[picked]];
  const pick = styleColour("pick");
  values.forEach((value, piece) => {
    if (!known.has(value)) known.set(value, way.colour(value));
    const colour = chosen.includes(piece) ? blend(known.get(value), pick, 0.6) : known.get(value);
    morph.read.now.set(colour, SLOT * piece + 8);
  });
  const { lines, axes, targets, spot, rod } = morph.scene;
  const tints = [[lines, "ink"], [axes, "axis"], [spot, "pick"], [rod, "pick"], ...targets.map((one) => [one, "target"])];
  for (const [object, name] of tints) object.material.uniforms.colour.value.setRGB(...styleColour(name), THREE.LinearSRGBColorSpace);
  const entry = ([name, colour]) => element("span", {}, element("span", { class: "swatch", style: `background: ${colour}` }), name);
  const entries = [...way.legend(values).map(entry), entry(["hinge axis", "var(--axis)"])];
  if (SPACE.targets.length > 0) entries.push(entry(["target", "var(--target)"]));
  byId("space-legend").replaceChildren(...entries);
}

function colourPieces() {
  if (!morph.scene) return;
  tintPieces();
  redraw();
}

let drawing3d = false;

function redraw() {
  if (drawing3d || !morph.scene) return;
  drawing3d = true;
  requestAnimationFrame(() => {
    drawing3d = false;
    draw();
    clearTimeout(morph.still);
    morph.still = setTimeout(keepStill, 1500);
  });
}

function draw() {
  const { scene, texture, lines, axes, targets, renderer } = morph.scene;
  poseSpace(morph.read, morph.moment);
  texture.needsUpdate = true;
  // Where pieces are some pixels wide their edges and axes would only blur them, and take most of the time.
  const width = morph.read.size / morph.orbit.pixel();
  lines.visible = width > 5;
  axes.visible = width > 3 && byId("space-axes").checked;
  // Of two targets that of the nearer state.
  targets.forEach((target, i) => {
    const near = targets.length === 1 || (SPACE.targets[i].state === "open") === morph.moment >= 0.5;
    target.visible = near && byId("space-target").checked;
  });
  markPicked();
  renderer.render(scene, morph.orbit.camera());
}

// The chosen hinge: a ball at its point and a rod along its axis, both seen through everything and never too small to see.
function markPicked() {
  const { spot, rod } = morph.scene;
  [spot.visible, rod.visible] = [picked !== null, picked !== null];
  if (picked === null) return;
  const hinge = morph.hinges[picked];
  const { size } = morph.read;
  const pixel = morph.orbit.pixel();
  const radius = Math.max(0.13 * size, 4.5 * pixel);
  const key = `${picked} ${fixed(radius, 4)}`;
  if (spot.key === key) return;
  spot.key = key;
  spot.geometry.dispose();
  rod.geometry.dispose();
  const ball = new THREE.SphereGeometry(radius, 20, 12);
  const places = ball.getAttribute("position").array;
  const corners = new Float32Array((places.length / 3) * 4);
  for (let i = 0; i < places.length / 3; i += 1) {
    corners.set([...more(hinge.own[0].point, places.slice(3 * i, 3 * i + 3)), hinge.pieces[0]], 4 * i);
  }
  spot.geometry = geometryOf(corners, Uint32Array.from(ball.getIndex().array));
  rod.geometry = rods([hinge], Math.max(0.04 * size, 1.2 * pixel), Math.max(0.5 * SPACE.thickness + 0.9 * size, 14 * pixel));
}

function fitSpace() {
  poseSpace(morph.read, morph.moment);
  const points = [];
  for (let piece = 0; piece < morph.read.count; piece += 1) points.push(...placeOf(morph.read.now, piece));
  morph.orbit.fit(points, morph.read.size);
}

// After the window or the lens changed: as before, unless what was fitted would no longer be.
function fitAgain() {
  if (morph.orbit.eye.fitted) fitSpace();
  redraw();
}

// What is seen, in words.
function spaceWords() {
  const share = `${Math.round(100 * morph.moment)} % open`;
  if (COUNT === 0) return share;
  return [share, ...wayWords(morph.moment)].join(", ");
}

// `told`: whether those who hear the page are told at once; else when it rests.
function setMoment(moment, told = true) {
  morph.moment = Math.min(Math.max(moment, 0), 1);
  slider.value = Math.round(1000 * morph.moment);
  slider.setAttribute("aria-valuetext", `${Math.round(100 * morph.moment)} % open`);
  byId("space-says").setAttribute("aria-live", told ? "polite" : "off");
  byId("space-says").textContent = spaceWords();
  markWay(morph.moment);
  redraw();
}

// To the other state: at once where motion is unwelcome, else within some seconds.
function playSpace() {
  const button = byId("space-play");
  const stop = () => {
    cancelAnimationFrame(morph.playing);
    morph.playing = 0;
    button.textContent = "Play";
  };
  if (morph.playing) {
    stop();
    return setMoment(morph.moment);
  }
  const to = morph.moment < 0.999 ? 1 : 0;
  if (calm.matches) return setMoment(to);
  button.textContent = "Stop";
  let last = null;
  const step = (time) => {
    const part = last === null ? 0 : (time - last) / 4000;
    last = time;
    const next = to === 1 ? Math.min(morph.moment + part, 1) : Math.max(morph.moment - part, 0);
    if (next === to) stop();
    else morph.playing = requestAnimationFrame(step);
    setMoment(next, next === to);
  };
  morph.playing = requestAnimationFrame(step);
}

function savePicture() {
  draw();
  inSpace.toBlob((blob) => {
    const link = element("a", { href: URL.createObjectURL(blob), download: `${DATA.job.replace(/[^\w.-]+/g, "_")}-${Math.round(100 * morph.moment)}.png` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  });
}

// A click: the piece under it, and of its hinges the nearest one.
function pickInSpace(x, y) {
  const piece = pieceOnRay(morph.read, ...morph.orbit.ray(x, y));
  const ids = allIds.filter((id) => piece === null || HINGES.piece_j[id] === piece || HINGES.piece_k[id] === piece);
  let [best, nearest] = [null, piece === null ? 20 : Infinity];
  for (const id of ids) {
    const at = morph.orbit.windowPlace(hingeNow(morph.read, morph.hinges[id]).point);
    const off = Math.hypot(at[0] - x, at[1] - y);
    if (off < nearest) [best, nearest] = [id, off];
  }
  if (best !== null) pick(best, "space");
}

function spaceKeys() {
  const { turn, nearer } = morph.orbit;
  const flat = byId("space-flat");
  const actions = {
    ArrowLeft: () => turn(0.12, 0), ArrowRight: () => turn(-0.12, 0), ArrowUp: () => turn(0, 0.12), ArrowDown: () => turn(0, -0.12),
    "+": () => nearer(0.8), "=": () => nearer(0.8), "-": () => nearer(1.25), " ": playSpace, f: fitSpace,
    o: () => flat.click(), "[": () => setMoment(morph.moment - 0.05), "]": () => setMoment(morph.moment + 0.05),
  };
  inSpace.addEventListener("keydown", (event) => {
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    action();
  });
}

// Printed is a still of the open state in light colours, made while nothing moves: browsers print what a canvas showed last.
// Of a large sheet, which a processor without a graphics card takes seconds for, the first one stays.
function keepStill() {
  if (morph.playing || (COUNT > MANY && byId("space-still").src)) return;
  const { moment } = morph;
  const page = document.documentElement;
  const { theme = "" } = page.dataset;
  page.dataset.theme = "light";
  morph.moment = 1;
  tintPieces();
  draw();
  byId("space-still").src = inSpace.toDataURL();
  page.dataset.theme = theme;
  morph.moment = moment;
  tintPieces();
  draw();
}

// Without WebGL the section says so, and keeps what needs none.
function spaceMissing() {
  byId("space-figure").hidden = true;
  byId("space-missing").hidden = false;
}

function startSpace() {
  const options = { antialias: true, alpha: true, preserveDrawingBuffer: true, premultipliedAlpha: true };
  const context = inSpace.getContext("webgl2", options);
  if (!context) return spaceMissing();
  const renderer = new THREE.WebGLRenderer({ canvas: inSpace, context, ...options });
  renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
  morph.orbit = orbiting(byId("space-stage"), redraw);
  morph.hinges = readHinges(morph.read);
  morph.scene = { ...buildScene(morph.read, morph.hinges), renderer };
  const resize = () => {
    const { clientWidth, clientHeight } = byId("space-stage");
    renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    renderer.setSize(Math.max(clientWidth, 1), Math.max(clientHeight, 1), false);
    fitAgain();
    draw();
  };
  fitSpace();
  colourPieces();
  resize();
  new ResizeObserver(resize).observe(byId("space-stage"));
  orbitGestures(inSpace, morph.orbit, pickInSpace);
  spaceKeys();
  onPick.push(colourPieces);
  onLoads.push(colourPieces);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", colourPieces);
  byId("theme").addEventListener("click", colourPieces);
  inSpace.dataset.ready = "yes";
}

function buildSpace() {
  byId("space").hidden = SPACE === null;
  if (SPACE === null) return;
  morph.read = readSpace();
  morph.ways = colourings();
  byId("space-colour").append(...morph.ways.map(({ words }, i) => element("option", { value: i }, words)));
  byId("space-colour").addEventListener("change", colourPieces);
  byId("space-target").closest("label").hidden = SPACE.targets.length === 0;
  for (const id of ["space-axes", "space-target"]) byId(id).addEventListener("change", redraw);
  byId("space-flat").addEventListener("change", () => {
    morph.orbit.eye.flat = byId("space-flat").checked;
    fitAgain();
  });
  byId("space-fit").addEventListener("click", fitSpace);
  byId("space-picture").addEventListener("click", savePicture);
  byId("space-play").addEventListener("click", playSpace);
  slider.addEventListener("input", () => setMoment(slider.value / 1000));
  drawWay();
  setMoment(1, false);
  // The card is asked for once the view is near to being seen.
  const watch = new IntersectionObserver((entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    watch.disconnect();
    startSpace();
  }, { rootMargin: "100px" });
  watch.observe(byId("space-stage"));
}
