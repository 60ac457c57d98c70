// What the report's view in space uses of three.js; everything else is left out of the bundle.
export {
  BufferAttribute, BufferGeometry, Color, DataTexture, DoubleSide, FloatType, GLSL3, LinearSRGBColorSpace, LineSegments, Matrix4,
  Mesh, OrthographicCamera, PerspectiveCamera, RawShaderMaterial, RGBAFormat, Scene, ShapeUtils, SphereGeometry, Vector2, Vector3,
  WebGLRenderer,
} from "three";
