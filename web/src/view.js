// The part in three dimensions: its mid-surface now, at rest as a ghost, the clamp, and the plane that blocks it.
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  CircleGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  EdgesGeometry,
  Group,
  LineBasicMaterial,
  LineSegments,
  Matrix4,
  Mesh,
  MeshBasicMaterial,
  MeshLambertMaterial,
  OrthographicCamera,
  PlaneGeometry,
  Scene,
  SRGBColorSpace,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { RAMP, rampIndex } from "./ramp.js";
import { blend } from "./shape.js";
import { colour } from "./theme.js";

/** The camera's angle above the ground, and beside the direction that shows the bending from the side. */
const ELEVATION = 0.22;
const ASIDE = 0.45;

/** `RAMP` in the renderer's linear colours. */
const LINEAR_RAMP = new Float32Array(RAMP.length);
for (let k = 0; k < RAMP.length; k += 3) {
  new Color().setRGB(RAMP[k], RAMP[k + 1], RAMP[k + 2], SRGBColorSpace).toArray(LINEAR_RAMP, k);
}

export class View {
  #host;
  #renderer;
  #scene = new Scene();
  #camera = new OrthographicCamera();
  #controls;
  #part = new Group();
  #shape = null;
  #surface = null;
  #planes = new Map();
  #values = null;
  #turned = false;
  #due = false;
  #onScale;

  /** Draws into `host`; `onScale(pixels of a millimetre)` is called when the zoom has changed. Throws without WebGL. */
  constructor(host, onScale) {
    this.#host = host;
    this.#onScale = onScale;
    // The buffer is kept so that the picture can be read, by a check or by "save image as".
    this.#renderer = new WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.#renderer.domElement.setAttribute("aria-label", "the design in three dimensions");
    host.prepend(this.#renderer.domElement);
    this.#camera.up.set(0, 0, 1);
    const light = new DirectionalLight("white", 2.1);
    light.position.set(-0.6, 0.8, 1.4);
    this.#camera.add(light);
    this.#scene.add(this.#camera, new AmbientLight("white", 1.5), this.#part);
    this.#controls = new OrbitControls(this.#camera, this.#renderer.domElement);
    this.#controls.addEventListener("start", () => (this.#turned = true));
    this.#controls.addEventListener("change", () => this.#redraw());
    new ResizeObserver(() => this.#resize()).observe(host);
  }

  /** Shows nothing. */
  clear() {
    this.#part.traverse(({ geometry, material }) => {
      geometry?.dispose();
      material?.dispose();
    });
    this.#part.clear();
    this.#shape = null;
    this.#redraw();
  }

  /** Takes a prepared shape; a person's own view direction is kept. */
  take(shape) {
    this.clear();
    this.#shape = shape;
    const geometry = new BufferGeometry();
    geometry.setIndex(shape.triangles);
    geometry.setAttribute("position", new BufferAttribute(shape.reference.slice(), 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(shape.reference.length), 3));
    this.#values = new Float32Array(shape.reference.length / 3);
    this.#surface = new Mesh(geometry, new MeshLambertMaterial({ vertexColors: true, side: DoubleSide }));
    // Bounds change with every frame, and the part is always in view.
    this.#surface.frustumCulled = false;

    const ghost = new BufferGeometry();
    ghost.setIndex(shape.triangles);
    ghost.setAttribute("position", new BufferAttribute(shape.reference, 3));
    const veil = { color: colour("muted"), transparent: true, opacity: 0.1, depthWrite: false };
    this.#part.add(this.#surface, new Mesh(ghost, new MeshBasicMaterial(veil)), clamp(shape, veil));
    const obstructed = shape.scenarios.filter(({ plane }) => plane);
    this.#planes = new Map(obstructed.map((scenario) => [scenario.name, blockingPlane(shape, scenario, veil)]));
    for (const plane of this.#planes.values()) this.#part.add(plane);
    if (!this.#turned) this.#aim();
    this.#fit();
  }

  /** Shows the part at `place` on the scenario's path, coloured by `name`; "plain" has one colour. */
  show(scenario, place, name) {
    const { position, color } = this.#surface.geometry.attributes;
    blend(scenario.frames, place, "positions", position.array);
    position.needsUpdate = true;
    this.#surface.geometry.computeVertexNormals();
    if (name === "plain") {
      const plain = new Color(colour("part"));
      for (let k = 0; k < color.count; k += 1) plain.toArray(color.array, 3 * k);
    } else {
      blend(scenario.frames, place, name, this.#values);
      const range = this.#shape.ranges[name];
      this.#values.forEach((value, k) => {
        const at = rampIndex(value, range);
        for (let channel = 0; channel < 3; channel += 1) color.array[3 * k + channel] = LINEAR_RAMP[at + channel];
      });
    }
    color.needsUpdate = true;
    for (const [name, plane] of this.#planes) plane.visible = scenario.name === name;
    this.#redraw();
  }

  /** Turns back to the direction that shows the bending. */
  reset() {
    this.#turned = false;
    if (!this.#shape) return;
    this.#aim();
    this.#fit();
  }

  /** Looks at the plane in which the part bends most, from a little aside. */
  #aim() {
    const { frames } = this.#shape.scenarios[0];
    const [start, end] = [this.#shape.reference, frames.at(-1).positions];
    const moved = new Vector3();
    for (let k = 0; k < start.length; k += 3) {
      moved.x += (end[k] - start[k]) * start[k + 2];
      moved.y += (end[k + 1] - start[k + 1]) * start[k + 2];
    }
    const side = moved.length() > 0 ? Math.atan2(moved.y, moved.x) - Math.PI / 2 : -Math.PI / 2;
    const angle = side + ASIDE;
    const direction = new Vector3(Math.cos(angle), Math.sin(angle), Math.tan(ELEVATION)).normalize();
    this.#camera.position.copy(direction).add(this.#controls.target);
  }

  /** Moves and zooms so that both paths, all along, are in view. */
  #fit() {
    const box = boundsOf(this.#shape);
    const centre = box.min.clone().add(box.max).multiplyScalar(0.5);
    const direction = this.#camera.position.clone().sub(this.#controls.target).normalize();
    const reach = box.max.distanceTo(box.min);
    this.#controls.target.copy(centre);
    this.#camera.position.copy(centre).addScaledVector(direction, 2 * reach);
    this.#camera.near = 0;
    this.#camera.far = 4 * reach;
    this.#camera.lookAt(centre);
    this.#camera.updateMatrixWorld();

    // The box in the camera's frame; its corners decide what must be seen.
    const inverse = this.#camera.matrixWorld.clone().invert();
    const half = { x: 0, y: 0 };
    for (let corner = 0; corner < 8; corner += 1) {
      const point = new Vector3(
        (corner & 1 ? box.max : box.min).x,
        (corner & 2 ? box.max : box.min).y,
        (corner & 4 ? box.max : box.min).z,
      ).applyMatrix4(inverse);
      half.x = Math.max(half.x, Math.abs(point.x));
      half.y = Math.max(half.y, Math.abs(point.y));
    }
    const { clientWidth: width, clientHeight: height } = this.#host;
    // Legend and scale stand at the sides.
    const room = Math.max(width - 150, 120);
    this.#camera.zoom = 0.92 * Math.min(room / (2 * half.x), height / (2 * half.y)) || 1;
    this.#resize();
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.#host;
    if (width === 0 || height === 0) return;
    this.#renderer.setPixelRatio(window.devicePixelRatio);
    this.#renderer.setSize(width, height, false);
    // One unit of the frustum is a pixel, so that the zoom is pixels per millimetre.
    Object.assign(this.#camera, { left: -width / 2, right: width / 2, top: height / 2, bottom: -height / 2 });
    this.#camera.updateProjectionMatrix();
    this.#controls.update();
    this.#redraw();
  }

  #redraw() {
    if (this.#due) return;
    this.#due = true;
    requestAnimationFrame(() => {
      this.#due = false;
      this.#renderer.render(this.#scene, this.#camera);
      this.#onScale(this.#shape ? this.#camera.zoom : null);
    });
  }
}

/** The box around the part at rest and in all frames. */
function boundsOf(shape) {
  const [min, max] = [new Vector3(Infinity, Infinity, Infinity), new Vector3(-Infinity, -Infinity, -Infinity)];
  const point = new Vector3();
  const all = [shape.reference, ...shape.scenarios.flatMap(({ frames }) => frames.map((frame) => frame.positions))];
  for (const positions of all) {
    for (let k = 0; k < positions.length; k += 3) {
      point.fromArray(positions, k);
      min.min(point);
      max.max(point);
    }
  }
  return { min, max };
}

/** A disc under the clamped end. */
function clamp({ reference }, veil) {
  let [ground, radius] = [Infinity, 0];
  for (let k = 2; k < reference.length; k += 3) ground = Math.min(ground, reference[k]);
  for (let k = 0; k < reference.length; k += 3) {
    if (reference[k + 2] < ground + 2) radius = Math.max(radius, Math.hypot(reference[k], reference[k + 1]));
  }
  const disc = new Mesh(
    new CircleGeometry(1.3 * radius, 48),
    new MeshBasicMaterial({ ...veil, opacity: 0.45, side: DoubleSide }),
  );
  disc.position.z = ground;
  return disc;
}

/** The plane, as large as the part ever is that it blocks, upright where it can be, with its edge drawn. */
function blockingPlane(shape, scenario, veil) {
  const [normal, point] = [new Vector3(...scenario.plane.normal).normalize(), new Vector3(...scenario.plane.point)];
  const { min, max } = boundsOf({ ...shape, scenarios: [scenario] });
  const [length, width] = [1.05 * (max.z - min.z), 1.1 * Math.max(max.x - min.x, max.y - min.y)];
  const axis = Math.abs(normal.z) < 0.9 ? new Vector3(0, 0, 1) : new Vector3(1, 0, 0);
  const across = new Vector3().crossVectors(axis, normal).normalize();
  const along = new Vector3().crossVectors(normal, across);
  // The part's middle, dropped onto the plane.
  const centre = min.clone().add(max).multiplyScalar(0.5);
  centre.addScaledVector(normal, normal.dot(point.clone().sub(centre)));

  const geometry = new PlaneGeometry(width, length);
  const plane = new Mesh(geometry, new MeshBasicMaterial({ ...veil, color: colour("smith"), opacity: 0.22, side: DoubleSide }));
  plane.add(new LineSegments(new EdgesGeometry(geometry), new LineBasicMaterial({ color: colour("smith") })));
  plane.applyMatrix4(new Matrix4().makeBasis(across, along, normal).setPosition(centre));
  return plane;
}
