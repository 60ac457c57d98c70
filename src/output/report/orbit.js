// The eye of the 3D view: it circles a point, in perspective or without, by pointers, wheel and keys.

const FIELD = 30;
const STEEPEST = 1.55;

function orbiting(box, changed) {
  const eye = { yaw: -1.15, pitch: 0.62, distance: 100, centre: new THREE.Vector3(), flat: false, reach: 100, fitted: false };
  const [lens, flatLens] = [new THREE.PerspectiveCamera(FIELD, 1, 1, 10), new THREE.OrthographicCamera()];
  const slope = Math.tan(0.5 * radians(FIELD));
  const aspect = () => Math.max(box.clientWidth, 1) / Math.max(box.clientHeight, 1);
  // Unit vectors to the right, up and towards the eye.
  const frameOf = () => {
    const [cy, sy, cp, sp] = [Math.cos(eye.yaw), Math.sin(eye.yaw), Math.cos(eye.pitch), Math.sin(eye.pitch)];
    return [[-sy, cy, 0], [-sp * cy, -sp * sy, cp], [cp * cy, cp * sy, sp]].map((v) => new THREE.Vector3(...v));
  };

  // The camera as it stands now. Without perspective it shows as much as with it in the plane of the centre.
  function camera() {
    const now = eye.flat ? flatLens : lens;
    const across = aspect();
    if (eye.flat) {
      const half = eye.distance * slope;
      Object.assign(now, { left: -half * across, right: half * across, top: half, bottom: -half });
    } else now.aspect = across;
    const apart = eye.distance + eye.centre.length();
    now.near = eye.flat ? -apart - 3 * eye.reach : Math.max(eye.distance - eye.centre.length() - 2 * eye.reach, 0.002 * apart);
    now.far = apart + 3 * eye.reach;
    const [right, up, towards] = frameOf();
    now.position.copy(eye.centre).addScaledVector(towards, eye.distance);
    now.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(right, up, towards));
    now.updateProjectionMatrix();
    now.updateMatrixWorld();
    return now;
  }

  // Brings points (x, y, z one after the other), each with as much around it, into sight from where the eye looks now.
  function fit(points, around) {
    const axes = frameOf();
    const along = axes.map((axis) => {
      const values = [];
      for (let i = 0; i < points.length; i += 3) values.push(axis.x * points[i] + axis.y * points[i + 1] + axis.z * points[i + 2]);
      return values;
    });
    const between = (values) => 0.5 * (extremes(values)[0] + extremes(values)[1]);
    const middle = along.map(between);
    const slopes = [slope * aspect(), slope];
    const depth = (i) => (eye.flat ? 0 : along[2][i] - middle[2]);
    const far = () => extremes(along[0].map((_, i) => depth(i) +
      Math.max(...[0, 1].map((k) => (Math.abs(along[k][i] - middle[k]) + around) / slopes[k]))))[1];
    eye.distance = far();
    // What is nearer looks larger, so the middle of the picture is not that of the points.
    for (let round = 0; round < 6; round += 1) {
      for (const k of [0, 1]) {
        const seen = along[k].map((value, i) => (value - middle[k]) / Math.max(eye.distance - depth(i), 1e-6));
        middle[k] += between(seen) * eye.distance;
      }
      eye.distance = far();
    }
    eye.centre.set(0, 0, 0);
    axes.forEach((axis, i) => eye.centre.addScaledVector(axis, middle[i]));
    eye.reach = Math.max(...along.map((values) => extremes(values)[1] - extremes(values)[0])) + 2 * around;
    eye.distance *= 1.04;
    eye.fitted = true;
    changed();
  }

  function turn(across, down) {
    eye.yaw -= across;
    eye.pitch = Math.min(Math.max(eye.pitch + down, -STEEPEST), STEEPEST);
    changed();
  }

  function nearer(factor) {
    eye.distance = Math.min(Math.max(eye.distance * factor, 0.01 * eye.reach), 20 * eye.reach);
    eye.fitted = false;
    changed();
  }

  // Millimetres per pixel at the centre.
  const pixel = () => (2 * eye.distance * slope) / Math.max(box.clientHeight, 1);

  // Moves the picture by pixels.
  function shift(across, down) {
    const [right, up] = frameOf();
    eye.centre.addScaledVector(right, -across * pixel()).addScaledVector(up, down * pixel());
    eye.fitted = false;
    changed();
  }

  // From where and which way a place of the window looks, in window coordinates.
  function ray(x, y) {
    const bounds = box.getBoundingClientRect();
    const across = (2 * (x - bounds.left)) / bounds.width - 1;
    const up = 1 - (2 * (y - bounds.top)) / bounds.height;
    const now = camera();
    const [from, to] = [-1, 1].map((depth) => new THREE.Vector3(across, up, depth).unproject(now));
    return [from.toArray(), to.sub(from).normalize().toArray()];
  }

  // Where a point of the page is in the window.
  function windowPlace(point) {
    const bounds = box.getBoundingClientRect();
    const seen = new THREE.Vector3(...point).project(camera());
    return [bounds.left + 0.5 * (seen.x + 1) * bounds.width, bounds.top + 0.5 * (1 - seen.y) * bounds.height];
  }

  return { camera, fit, turn, nearer, pixel, shift, ray, windowPlace, eye };
}

// Dragging turns; with Shift, the right button or two pointers it moves. `clicked`: where a pointer went up that had not moved.
function orbitGestures(target, orbit, clicked) {
  const pointers = new Map();
  let [travelled, sliding] = [0, false];
  target.addEventListener("contextmenu", (event) => event.preventDefault());
  target.addEventListener("pointerdown", (event) => {
    target.setPointerCapture(event.pointerId);
    if (pointers.size === 0) [travelled, sliding] = [0, event.button === 2 || event.shiftKey];
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  target.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const [across, down] = [now[0] - before[0], now[1] - before[1]];
    travelled += Math.hypot(across, down);
    const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
    pointers.set(event.pointerId, now);
    if (other) {
      const apart = (point) => Math.max(Math.hypot(point[0] - other[0], point[1] - other[1]), 1);
      orbit.nearer(apart(before) / apart(now));
      orbit.shift(0.5 * across, 0.5 * down);
    } else if (travelled > 4) {
      if (sliding) orbit.shift(across, down);
      else orbit.turn(0.008 * across, 0.008 * down);
    }
  });
  const end = (event) => {
    if (!pointers.delete(event.pointerId)) return;
    if (event.type === "pointerup" && travelled <= 4 && event.button === 0) clicked(event.clientX, event.clientY);
  };
  target.addEventListener("pointerup", end);
  target.addEventListener("pointercancel", end);
  target.addEventListener("wheel", (event) => {
    if (!event.ctrlKey && !event.metaKey && document.activeElement !== target) return;
    event.preventDefault();
    orbit.nearer(Math.exp(Math.max(-0.5, Math.min(0.5, event.deltaY * 0.0018))));
  }, { passive: false });
}
