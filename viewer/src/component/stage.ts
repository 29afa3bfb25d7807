/** Renderer, camera and controls; draws only after a change. */

import {
  DirectionalLight,
  Group,
  Matrix4,
  MOUSE,
  NeutralToneMapping,
  NoToneMapping,
  PerspectiveCamera,
  Scene,
  Spherical,
  type Texture,
  TOUCH,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { View } from "./cleave-viewer";
import type { Drawing } from "./drawing";
import type { Projection } from "./sight";
import { IdBuffer } from "./id_buffer";

export type { View };

export const FIRST_VIEW: View = { azimuth: 0.55, polar: 1.18, distance: 3.5, target: [0, 0, 0] };

const FIELD_OF_VIEW = 32; // degrees, along the shorter side
const MOST_PIXELS = 2; // device pixels per CSS pixel; more cost much and show little
const ENTRANCE_MS = 1100;
const LATE_MS = 45; // from the request of a frame to its start
const LEAST_SHARPNESS = 0.35;
const REST_MS = 350;
const GLIDE_MS = 400;
const KEY_STEP = Math.PI / 24;

export class Stage {
  readonly canvas: HTMLCanvasElement;
  readonly onView: () => void;
  readonly #renderer: WebGLRenderer;
  readonly #scene = new Scene();
  readonly #upright = new Group();
  readonly #camera = new PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 100);
  readonly #controls: OrbitControls;
  readonly #ids = new IdBuffer();
  #drawing: Drawing | null = null;
  #frame = 0;
  #requestedAt = 0;
  #late = 0;
  #sharpness = 1;
  #resting = 0;
  #entrance = 0;
  #reach = 1;
  /** The size for which the numbers of faces are drawn: a lower resolution of the picture leaves them. */
  #framed = "";
  /** Whether the canvas had no size when it was to get that of the page. */
  #isUnsized = false;

  /** ``onView`` is called after the camera has moved. Throws if the browser has no WebGL 2. */
  constructor(canvas: HTMLCanvasElement, onView: () => void) {
    this.canvas = canvas;
    this.onView = onView;
    this.#renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: false });
    this.#renderer.toneMapping = NoToneMapping;
    this.#renderer.setClearColor(0, 0);
    this.#scene.add(this.#upright);
    this.#controls = new OrbitControls(this.#camera, canvas);
    this.#controls.enableDamping = true;
    this.#controls.dampingFactor = 0.12;
    this.#controls.zoomToCursor = true;
    this.#controls.addEventListener("change", () => this.#moved());
    this.#controls.addEventListener("start", () => this.#endEntrance());
    this.view = FIRST_VIEW;
  }

  get drawCalls(): number {
    return this.#renderer.info.render.calls;
  }

  /** Numbers of objects in GPU memory. */
  get memory(): { geometries: number; textures: number } {
    const { geometries, textures } = this.#renderer.info.memory;
    return { geometries, textures };
  }

  get view(): View {
    const { target } = this.#controls;
    const around = new Spherical().setFromVector3(this.#camera.position.clone().sub(target));
    return { azimuth: around.theta, polar: around.phi, distance: around.radius, target: target.toArray() };
  }

  set view(view: View) {
    this.#controls.target.fromArray([...view.target]);
    const around = new Spherical(view.distance, view.polar, view.azimuth).makeSafe();
    this.#camera.position.setFromSpherical(around).add(this.#controls.target);
    this.#controls.update();
    this.#moved();
  }

  /** Whether the z axis of the mesh points up instead of its y axis. */
  set isZUp(isZUp: boolean) {
    this.#upright.rotation.x = isZUp ? -Math.PI / 2 : 0;
    this.changed();
  }

  /** Radius around the centre that the clipping planes enclose, in radii of the model. */
  set reach(reach: number) {
    this.#reach = reach;
    this.#clip();
  }

  /** Light the original materials; ``make`` returns their surroundings and is called once. */
  light(make: (renderer: WebGLRenderer) => Texture): void {
    if (this.#scene.environment !== null) return;
    this.#scene.environment = make(this.#renderer);
    this.#scene.environmentIntensity = 0.55; // set by hand, with the light: white stays below white, and faces differ
    const light = new DirectionalLight(0xffffff, 1.3);
    light.position.set(0.38, 0.72, 0.58);
    this.#camera.add(light);
    this.#scene.add(this.#camera); // so that the light moves with it
    this.#renderer.toneMapping = NeutralToneMapping;
  }

  show(drawing: Drawing | null): void {
    this.#drawing = drawing;
    this.#framed = "";
    if (drawing !== null) this.#upright.add(drawing.group);
    this.#fit();
    this.changed(); // with the next frame, when the state of its parts is set
  }

  /** Animate the camera into the first view, unless reduced motion is preferred. */
  enter(): void {
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    const end = this.view;
    this.#animate(ENTRANCE_MS, (t) => {
      const left = (1 - t) ** 4;
      this.view = { ...end, azimuth: end.azimuth - 1.2 * left, distance: end.distance * (1 + 0.35 * left) };
      if (this.#drawing !== null) this.#drawing.fadeIn = 1 - (1 - t) ** 3 * 0.9;
    });
  }

  /** Move the camera to a view, at once if reduced motion is preferred. */
  glideTo(end: View): void {
    const start = this.view;
    const between = (a: number, b: number, share: number) => a + (b - a) * share;
    this.#animate(matchMedia("(prefers-reduced-motion: reduce)").matches ? 0 : GLIDE_MS, (t) => {
      const share = 1 - (1 - t) ** 3;
      this.view = {
        azimuth: between(start.azimuth, end.azimuth, share),
        polar: between(start.polar, end.polar, share),
        distance: between(start.distance, end.distance, share),
        target: end.target.map((value, k) => between(start.target[k]!, value, share)) as [number, number, number],
      };
    });
  }

  resize(): void {
    if (!this.#fit()) return;
    // A resized canvas is blank: draw before the browser shows it.
    this.draw();
  }

  /** Take the size of the canvas on the page; return false if it has none. */
  #fit(): boolean {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.#isUnsized = width === 0 || height === 0;
    if (this.#isUnsized) return false;
    const ratio = Math.min(devicePixelRatio, MOST_PIXELS) * this.#sharpness;
    this.#renderer.setPixelRatio(ratio);
    this.#renderer.setSize(width, height, false);
    this.#camera.aspect = width / height;
    const [top, bottom] = ["top", "bottom"].map((side) => insetOf(this.canvas, side)) as [number, number];
    const shorter = Math.max(Math.min(width, height - top - bottom), height / 3);
    this.#camera.fov = (2 * Math.atan((Math.tan((FIELD_OF_VIEW * Math.PI) / 360) * height) / shorter) * 180) / Math.PI;
    this.#camera.setViewOffset(width, height, 0, (bottom - top) / 2, width, height);
    this.#ids.resize(width, height);
    this.#drawing?.resize(width * ratio, height * ratio, ratio);
    const framed = [width, height, top, bottom].join();
    if (framed === this.#framed) this.repaint();
    else this.changed();
    this.#framed = framed;
    return true;
  }

  /** Request a new frame after a change of what is where. */
  changed(): void {
    this.#ids.isStale = true;
    this.repaint();
  }

  /** Request a new frame after a change of colours. */
  repaint(): void {
    if (this.#frame !== 0) return;
    this.#requestedAt = performance.now();
    this.#frame = requestAnimationFrame(() => {
      this.#adaptResolution(performance.now() - this.#requestedAt);
      this.draw();
    });
  }

  draw(): void {
    cancelAnimationFrame(this.#frame);
    this.#frame = 0;
    // The lines of a drawing that does not know the size would cover the whole picture.
    if (this.#isUnsized) return this.resize();
    this.#controls.update();
    this.#renderer.render(this.#scene, this.#camera);
  }

  /** Draw, and wait until the GPU has finished. */
  finish(): void {
    this.draw();
    const gl = this.#renderer.getContext();
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  }

  /** Return the leaf at a position of the canvas in CSS pixels, or the drawn face in a partition; -1 if there is none. */
  idAt(x: number, y: number): number {
    return this.ids()?.at(x, y) ?? -1;
  }

  /** Return the numbers of what is drawn at each pixel; null if nothing is shown. */
  ids(): IdBuffer | null {
    const drawing = this.#drawing;
    if (drawing === null) return null;
    if (this.#ids.isStale) drawing.withPickMaterial(() => this.#ids.draw(this.#renderer, this.#scene, this.#camera));
    return this.#ids;
  }

  /** Return how the coordinates of the model are projected; null if nothing is shown. */
  projection(): Projection | null {
    if (this.#drawing === null) return null;
    this.#camera.updateMatrixWorld();
    this.#drawing.group.updateWorldMatrix(true, false);
    const world = this.#drawing.group.matrixWorld;
    const toClip = new Matrix4().multiplyMatrices(this.#camera.projectionMatrix, this.#camera.matrixWorldInverse).multiply(world);
    const eye = this.#camera.position.clone().applyMatrix4(world.clone().invert());
    const { clientWidth: width, clientHeight: height } = this.canvas;
    return { toClip: toClip.elements, eye: eye.toArray(), width, height };
  }

  /** What the main button or one finger does: turn the model, or nothing, so that a tool draws. */
  set isDrawing(isDrawing: boolean) {
    const { mouseButtons, touches } = this.#controls;
    mouseButtons.LEFT = isDrawing ? null : MOUSE.ROTATE;
    mouseButtons.RIGHT = isDrawing ? MOUSE.ROTATE : MOUSE.PAN;
    touches.ONE = isDrawing ? null : TOUCH.ROTATE;
    touches.TWO = isDrawing ? TOUCH.DOLLY_ROTATE : TOUCH.DOLLY_PAN;
  }

  /** Return a PNG of the present view, without a background. */
  async picture(): Promise<Blob> {
    this.#sharpness = 1;
    this.resize();
    return new Promise((resolve, reject) => {
      this.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error("The picture could not be created."))));
    });
  }

  turn(right: number, up: number): void {
    const { azimuth, polar, ...rest } = this.view;
    this.view = { ...rest, azimuth: azimuth + right * KEY_STEP, polar: polar + up * KEY_STEP };
  }

  zoom(factor: number): void {
    this.view = { ...this.view, distance: this.view.distance * factor };
  }

  dispose(): void {
    cancelAnimationFrame(this.#frame);
    clearTimeout(this.#resting);
    this.#endEntrance();
    this.#controls.dispose();
    this.#ids.dispose();
    this.#scene.environment?.dispose();
    this.#renderer.dispose();
    this.#renderer.forceContextLoss();
  }

  /** Lower the resolution while frames are late, and restore it after a pause. */
  #adaptResolution(delay_ms: number): void {
    this.#late = delay_ms > LATE_MS ? this.#late + 1 : 0;
    if (this.#late > 1 && this.#sharpness > LEAST_SHARPNESS) {
      this.#late = 0;
      this.#sharpness = Math.max(this.#sharpness * 0.6, LEAST_SHARPNESS);
      this.resize();
    }
    clearTimeout(this.#resting);
    if (this.#sharpness < 1)
      this.#resting = setTimeout(() => {
        this.#sharpness = 1;
        this.resize();
      }, REST_MS);
  }

  /** Call ``show`` with the elapsed share of a time, 0..1, until it is over or the user moves the camera. */
  #animate(duration_ms: number, show: (t: number) => void): void {
    this.#endEntrance();
    const began = performance.now();
    const step = () => {
      const t = duration_ms === 0 ? 1 : Math.min((performance.now() - began) / duration_ms, 1);
      show(t);
      this.#entrance = t < 1 ? requestAnimationFrame(step) : 0;
    };
    step();
  }

  #endEntrance(): void {
    cancelAnimationFrame(this.#entrance);
    this.#entrance = 0;
    if (this.#drawing !== null) this.#drawing.fadeIn = 1;
  }

  #moved(): void {
    this.#clip();
    this.changed();
    this.onView();
  }

  #clip(): void {
    const distance = this.#camera.position.distanceTo(new Vector3());
    this.#camera.near = Math.max(distance - this.#reach, 0.005 * this.#reach);
    this.#camera.far = distance + this.#reach;
    this.#camera.updateProjectionMatrix();
  }
}

/** Return the height in CSS pixels that something covers at the top or the bottom of the canvas. */
function insetOf(canvas: HTMLCanvasElement, side: string): number {
  return Math.max(Number.parseFloat(getComputedStyle(canvas).getPropertyValue(`--cleave-inset-${side}`)) || 0, 0);
}
