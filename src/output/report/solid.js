// What the graphics card draws: one mesh of all pieces, their edges, the axes, the targets. Poses and colours are in a texture,
// so that a move of the slider sends some numbers per piece and no vertex.

// Texels of a piece: quaternion, place, colour. Pieces per row of the texture.
const [TEXELS, ACROSS] = [3, 512];

const PLACING = `
precision highp float;
precision highp sampler2D;
uniform mat4 viewMatrix, projectionMatrix;
uniform sampler2D pieces;
in vec4 corner;
out vec3 seen;
flat out vec3 tint, up;
vec4 texel(int piece, int i) { return texelFetch(pieces, ivec2(${TEXELS} * (piece % ${ACROSS}) + i, piece / ${ACROSS}), 0); }
vec3 turned(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
void main() {
  int piece = int(corner.w + 0.5);
  vec4 turn = texel(piece, 0);
  vec4 at = viewMatrix * vec4(turned(turn, corner.xyz) + texel(piece, 1).xyz, 1.0);
  seen = at.xyz;
  up = mat3(viewMatrix) * turned(turn, vec3(0.0, 0.0, 1.0));
  tint = texel(piece, 2).rgb;
  gl_Position = projectionMatrix * at;
}`;

// Light from the upper left of the eye; the sheet's underside is darker.
const SHADING = `
precision highp float;
in vec3 seen;
flat in vec3 tint, up;
uniform vec3 colour;
uniform float own, opacity;
out vec4 shown;
void main() {
  vec3 across = cross(dFdx(seen), dFdy(seen));
  // Lines have no face.
  vec3 normal = dot(across, across) > 0.0 ? normalize(across) : vec3(0.0, 0.0, 1.0);
  if (normal.z < 0.0) normal = -normal;
  float light = 0.58 + 0.46 * max(dot(normal, normalize(vec3(-0.35, 0.5, 1.0))), 0.0);
  float side = dot(normal, normalize(up)) < -0.5 ? 0.72 : 1.0;
  shown = vec4(mix(colour * mix(light, 1.0, 0.5), tint * light * side, own) * opacity, opacity);
}`;

// A target stands where it is, but for the depth a little behind: pieces that lie in it are not half hidden by it.
const STANDING = `
precision highp float;
uniform mat4 viewMatrix, projectionMatrix;
in vec3 position;
uniform float behind;
out vec3 seen;
flat out vec3 tint, up;
void main() {
  vec4 at = viewMatrix * vec4(position, 1.0);
  seen = at.xyz;
  tint = vec3(0.0);
  up = vec3(0.0, 0.0, 1.0);
  gl_Position = projectionMatrix * at;
  vec4 back = projectionMatrix * (at - vec4(0.0, 0.0, behind, 0.0));
  gl_Position.z = back.z / back.w * gl_Position.w;
}`;

function shaded(pieces, { own = 0, opacity = 1, behind = 0, ...others } = {}) {
  const values = { pieces, own, opacity, behind, colour: new THREE.Color() };
  return new THREE.RawShaderMaterial({
    glslVersion: THREE.GLSL3, vertexShader: pieces ? PLACING : STANDING, fragmentShader: SHADING, side: THREE.DoubleSide,
    uniforms: Object.fromEntries(Object.entries(values).map(([name, value]) => [name, { value }])),
    premultipliedAlpha: true, transparent: opacity < 1, ...others,
  });
}

function poseTexture(read) {
  const rows = Math.max(Math.ceil(read.count / ACROSS), 1);
  const texels = new Float32Array(4 * TEXELS * ACROSS * rows);
  read.now = texels;
  return new THREE.DataTexture(texels, TEXELS * ACROSS, rows, THREE.RGBAFormat, THREE.FloatType);
}

function geometryOf(corners, index) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("corner", new THREE.BufferAttribute(corners, 4));
  geometry.setIndex(new THREE.BufferAttribute(index, 1));
  return geometry;
}

// An object that is never left out for standing aside: only the card knows where it is.
function present(object) {
  object.frustumCulled = false;
  return object;
}

// Prisms over the outlines: vertices 2i above and 2i + 1 below.
function prisms(read) {
  const half = 0.5 * SPACE.thickness;
  const total = read.starts[read.count];
  const corners = new Float32Array(8 * total);
  const [faces, edges] = [[], []];
  for (let piece = 0; piece < read.count; piece += 1) {
    const [start, end] = [read.starts[piece], read.starts[piece + 1]];
    const outline = [];
    for (let i = start; i < end; i += 1) {
      const [x, y] = [read.corners[2 * i], read.corners[2 * i + 1]];
      corners.set([x, y, half, piece, x, y, -half, piece], 8 * i);
      outline.push(new THREE.Vector2(x, y));
      const next = i + 1 < end ? i + 1 : start;
      faces.push(2 * i, 2 * i + 1, 2 * next, 2 * next, 2 * i + 1, 2 * next + 1);
      edges.push(2 * i, 2 * next, 2 * i + 1, 2 * next + 1);
    }
    for (const triangle of THREE.ShapeUtils.triangulateShape(outline, [])) {
      const [a, b, c] = triangle.map((i) => 2 * (start + i));
      faces.push(a, b, c, a + 1, c + 1, b + 1);
    }
  }
  return { corners, faces: Uint32Array.from(faces), edges: Uint32Array.from(edges) };
}

// A thin rod of three sides along the axis of each hinge, fixed to its first piece.
function rods(hinges, radius, half) {
  const corners = new Float32Array(24 * hinges.length);
  const index = new Uint32Array(18 * hinges.length);
  const sides = [[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4], [2, 0, 5], [0, 3, 5]].flat();
  hinges.forEach(({ pieces, own }, id) => {
    const { point, axis } = own[0];
    const least = axis.map(Math.abs).indexOf(Math.min(...axis.map(Math.abs)));
    const [ux, uy, uz] = [0, 1, 2].map((i) => (i === least ? 1 : 0) - axis[least] * axis[i]);
    const length = Math.hypot(ux, uy, uz);
    const u = [ux / length, uy / length, uz / length];
    const v = [axis[1] * u[2] - axis[2] * u[1], axis[2] * u[0] - axis[0] * u[2], axis[0] * u[1] - axis[1] * u[0]];
    for (let i = 0; i < 6; i += 1) {
      const turn = (2 * Math.PI * (i % 3)) / 3;
      const end = more(point, axis, i < 3 ? half : -half);
      const corner = more(more(end, u, radius * Math.cos(turn)), v, radius * Math.sin(turn));
      corners.set([...corner, pieces[0]], 24 * id + 4 * i);
    }
    index.set(sides.map((i) => 6 * id + i), 18 * id);
  });
  return geometryOf(corners, index);
}

function targetGeometry({ points, faces, unit }) {
  const geometry = new THREE.BufferGeometry();
  const places = Float32Array.from(new Int16Array(bytesOf(points)), (whole) => whole * unit);
  geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
  geometry.setIndex(new THREE.BufferAttribute(new Uint16Array(bytesOf(faces)), 1));
  return geometry;
}

// All that is drawn, and what is needed to change it.
function buildScene(read, hinges) {
  const scene = new THREE.Scene();
  const texture = poseTexture(read);
  const add = (object) => {
    scene.add(present(object));
    return object;
  };
  const { corners, faces, edges } = prisms(read);
  const body = geometryOf(corners, faces);
  const outlineOf = new THREE.BufferGeometry();
  outlineOf.setAttribute("corner", body.getAttribute("corner"));
  outlineOf.setIndex(new THREE.BufferAttribute(edges, 1));
  const pushed = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 };
  const pieces = add(new THREE.Mesh(body, shaded(texture, { own: 1, ...pushed })));
  const lines = add(new THREE.LineSegments(outlineOf, shaded(texture, { opacity: 0.4 })));
  const axes = add(new THREE.Mesh(rods(hinges, 0.028 * read.size, 0.5 * SPACE.thickness + 0.42 * read.size), shaded(texture)));
  const veil = { opacity: 0.24, depthWrite: false, behind: SPACE.thickness + 0.3 * read.size };
  const targets = SPACE.targets.map((target) => add(new THREE.Mesh(targetGeometry(target), shaded(null, veil))));
  // The chosen hinge shines through what is before it.
  const mark = () => add(new THREE.Mesh(new THREE.BufferGeometry(), shaded(texture, { opacity: 0.9, depthTest: false })));
  const [spot, rod] = [mark(), mark()];
  [spot.renderOrder, rod.renderOrder] = [2, 2];
  return { scene, texture, pieces, lines, axes, targets, spot, rod };
}
