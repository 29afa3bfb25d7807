/** The three.js objects of one model: surface, wireframe and lines, on one vertex buffer. */

import {
  BufferAttribute,
  BufferGeometry,
  CustomBlending,
  DoubleSide,
  GLSL3,
  Group,
  InstancedBufferAttribute,
  InstancedBufferGeometry,
  Mesh,
  NormalBlending,
  type Object3D,
  OneFactor,
  OneMinusSrcAlphaFactor,
  RawShaderMaterial,
  Sphere,
  Vector2,
  Vector3,
  Vector4,
} from "three";
import { Appearance } from "./appearance";
import { vertexConcavity } from "./concavity";
import { borderLines, concaveLines, partBorders, type SurfaceLines } from "./edges";
import type { FaceLabels } from "./face_labels";
import type { Model } from "./glb";
import type { Look } from "./look";
import type { Original } from "./original";
import type { PartitionedModel } from "./partition";
import {
  LINE_FRAGMENT,
  LINE_VERTEX,
  PICK_FRAGMENT,
  PICK_VERTEX,
  PLAIN_FRAGMENT,
  SURFACE_FRAGMENT,
  SURFACE_VERTEX,
  WIRE_VERTEX,
} from "./shaders";
import type { Surface } from "./surface";

/** Colours of lines and background for one theme; sRGB and opacity in 0..1. */
export interface Inks {
  readonly line: readonly [number, number, number, number];
  readonly selected: readonly [number, number, number, number];
  readonly concave: readonly [number, number, number, number];
  readonly mark: readonly [number, number, number, number];
  readonly wire: readonly [number, number, number, number];
  readonly sky: readonly [number, number, number];
}

const VEIL: Record<Look, number> = { parts: -1, original: 0, both: 0.45 }; // opacity; set by hand
const CLEAR = [0, 0, 0, 0] as const;
const HALF_LINE = 0.75; // CSS pixels
const GROWTH = 0.6; // of the radius at explode = 1

export class Drawing {
  readonly group = new Group();
  readonly #model: Model;
  readonly #surface: Surface;
  readonly #leaves: Appearance;
  readonly #geometry: BufferGeometry;
  /** What replaces the leaves by the parts of a partition. */
  #partition: { appearance: Appearance; labels: FaceLabels; edges: Int32Array } | null = null;
  /** The surface with three vertices for each face, so that the shaders can look up the part of the face of a vertex. */
  #byFace: BufferGeometry | null = null;
  readonly #materials: RawShaderMaterial[] = [];
  readonly #surfaceMaterial: RawShaderMaterial;
  readonly #pickMaterial: RawShaderMaterial;
  readonly #surfaceMesh: Mesh;
  #markMaterial: RawShaderMaterial | null = null;
  #wires: Mesh | null = null;
  #borders: Mesh | null = null;
  #concave: Mesh | null = null;
  #marks: Mesh | null = null;
  #original: Original | null = null;
  #look: Look = "parts";
  #inks: Inks;
  #size = { width: 1, height: 1, ratio: 1 };

  constructor(model: Model, surface: Surface, inks: Inks) {
    this.#model = model;
    this.#surface = surface;
    this.#inks = inks;
    this.#leaves = new Appearance({ ...model, ...surface });
    this.#geometry = surfaceGeometry(surface);
    this.#surfaceMaterial = this.#material(SURFACE_VERTEX, SURFACE_FRAGMENT, {
      fadeIn: { value: 1 },
      sky: { value: new Vector3() },
      concaveInk: { value: new Vector4() },
      isBentShown: { value: false },
      veil: { value: VEIL.parts },
    });
    this.#pickMaterial = this.#material(PICK_VERTEX, PICK_FRAGMENT, {});
    this.#surfaceMesh = new Mesh(this.#geometry, this.#surfaceMaterial);
    this.#surfaceMesh.frustumCulled = false;
    this.group.add(this.#surfaceMesh);
    this.explode = 0;
    this.applyInks(inks);
  }

  get appearance(): Appearance {
    return this.#partition?.appearance ?? this.#leaves;
  }

  /** Show the parts of a partition in place of the leaves of the tree; ``edges`` as sharedEdges returns them. */
  showPartition(model: PartitionedModel, labels: FaceLabels, edges: Int32Array): void {
    if (this.#partition === null) {
      this.marked = null;
      this.#leaves.showAll(); // the original moves and hides nothing
    }
    this.#partition?.appearance.dispose();
    this.#partition = { appearance: new Appearance(model), labels, edges };
    this.#useParts();
    this.#redrawLines();
  }

  /** Show the leaves of the tree again. */
  showLeaves(): void {
    if (this.#partition === null) return;
    this.#partition.appearance.dispose();
    this.#partition = null;
    this.#useParts();
    this.#redrawLines();
  }

  #useParts(): void {
    const { appearance } = this;
    const geometry = this.#partition === null ? this.#geometry : (this.#byFace ??= unshared(this.#geometry));
    this.#surfaceMesh.geometry = geometry;
    if (this.#wires !== null) this.#wires.geometry = geometry;
    for (const material of this.#materials) this.#useAppearance(material, appearance);
  }

  #useAppearance(material: RawShaderMaterial, appearance: Appearance): void {
    const { uniforms } = material;
    uniforms["leaves"]!.value = appearance.texture;
    uniforms["columns"]!.value = appearance.columns;
    const isByFace = this.#partition !== null;
    if (isByFace) uniforms["faceParts"] = { value: this.#partition!.labels.texture };
    if (isByFace) uniforms["faceColumns"] = { value: this.#partition!.labels.columns };
    if (isByFace === "BY_FACE" in material.defines) return;
    material.defines = isByFace ? { BY_FACE: "" } : {};
    material.needsUpdate = true;
  }

  #redrawLines(): void {
    const [borders, concave] = [this.#borders, this.#concave];
    if (borders !== null) replaceGeometry(borders, lineGeometry(this.#borderLines()));
    if (concave?.visible) replaceGeometry(concave, lineGeometry(this.#concaveLines()));
  }

  #borderLines(): SurfaceLines {
    if (this.#partition === null) return borderLines(this.#model, this.#surface);
    return partBorders(this.#model, this.#partition.edges, this.#partition.labels.parts);
  }

  #concaveLines(): SurfaceLines {
    return concaveLines(this.#model, this.#surface, this.#partition?.labels.parts);
  }

  /** Set the brightness during the entrance, 0..1. */
  set fadeIn(value: number) {
    this.#surfaceMaterial.uniforms["fadeIn"]!.value = value;
  }

  /** Scale the model into the unit ball around the origin, also with its parts moved apart. */
  set explode(explode: number) {
    const { centre, radius } = this.#surface;
    const scale = 1 / (radius * (1 + GROWTH * explode));
    this.group.scale.setScalar(scale);
    this.group.position.set(...centre).multiplyScalar(-scale);
  }

  get original(): Original | null {
    return this.#original;
  }

  /** Take over the objects that the looks ``original`` and ``both`` show. */
  set original(original: Original | null) {
    this.#original = original;
    if (original !== null) this.group.add(original.group);
    this.look = this.#look;
  }

  /** Choose what is shown; ``original`` and ``both`` need the original. */
  set look(look: Look) {
    this.#look = look;
    const isVeil = look !== "parts";
    if (this.#original !== null) this.#original.group.visible = isVeil;
    this.#surfaceMaterial.uniforms["veil"]!.value = VEIL[look];
    this.#surfaceMaterial.transparent = isVeil;
    if (isVeil) blendAsInk(this.#surfaceMaterial);
    else this.#surfaceMaterial.blending = NormalBlending;
    this.#surfaceMaterial.depthWrite = !isVeil;
    this.#surfaceMesh.renderOrder = isVeil ? 1 : 0; // above all materials of the original
    this.applyInks(this.#inks);
  }

  /** Update what depends on the state of the parts. */
  update(): void {
    this.#original?.show(this.#leaves);
  }

  applyInks(inks: Inks): void {
    this.#inks = inks;
    (this.#surfaceMaterial.uniforms["sky"]!.value as Vector3).fromArray([...inks.sky]);
    setInk(this.#surfaceMesh, "concaveInk", inks.concave);
    setInk(this.#wires, "ink", inks.wire);
    setInk(this.#borders, "ink", this.#look === "original" ? CLEAR : inks.line);
    setInk(this.#borders, "selectedInk", inks.selected);
    setInk(this.#concave, "ink", inks.concave);
    setInk(this.#marks, "ink", inks.mark);
  }

  /** Set the size of the canvas in device pixels, and the number of device pixels per CSS pixel. */
  resize(width: number, height: number, ratio: number): void {
    this.#size = { width, height, ratio };
    for (const { uniforms } of this.#materials) {
      (uniforms["pixels"]?.value as Vector2 | undefined)?.set(width / 2, height / 2);
      if (uniforms["width"] !== undefined) uniforms["width"].value = HALF_LINE * Math.max(ratio, 1);
    }
  }

  set wireframe(isShown: boolean) {
    if (isShown && this.#wires === null) {
      const material = this.#material(WIRE_VERTEX, PLAIN_FRAGMENT, { ink: { value: new Vector4() } }, true);
      material.wireframe = true;
      this.#wires = new Mesh(this.#surfaceMesh.geometry, material);
      this.#add(this.#wires, 2);
    }
    if (this.#wires !== null) this.#wires.visible = isShown;
  }

  set borders(isShown: boolean) {
    if (isShown && this.#borders === null) {
      this.#borders = this.#lineMesh(this.#borderLines());
      this.#add(this.#borders, 4);
    }
    if (this.#borders !== null) this.#borders.visible = isShown;
  }

  set concavity(isShown: boolean) {
    this.#surfaceMaterial.uniforms["isBentShown"]!.value = isShown;
    if (isShown && this.#concave === null) {
      const bent = vertexConcavity(this.#model, this.#surface);
      this.#geometry.setAttribute("concavity", new BufferAttribute(bent, 1, true));
      this.#byFace?.dispose(); // it has no concavity
      this.#byFace = null;
      this.#useParts();
      this.#concave = this.#lineMesh(this.#concaveLines());
      this.#add(this.#concave, 3);
    }
    if (this.#concave === null || this.#concave.visible === isShown) return;
    this.#concave.visible = isShown;
    if (isShown) this.#redrawLines();
  }

  /** Cover some faces, numbered as in the model, with the ink of marks; null for none. */
  set marked(faces: Uint32Array | null) {
    this.#marks?.geometry.dispose();
    this.#marks?.removeFromParent();
    this.#marks = null;
    if (faces === null || faces.length === 0) return;
    const geometry = new BufferGeometry();
    for (const name of ["position", "normalAndLeaf"]) geometry.setAttribute(name, this.#geometry.getAttribute(name));
    const { index } = this.#surface;
    const corners = new Uint32Array(3 * faces.length);
    faces.forEach((face, i) => corners.set(index.subarray(3 * face, 3 * face + 3), 3 * i));
    geometry.setIndex(new BufferAttribute(corners, 1));
    this.#markMaterial ??= this.#material(WIRE_VERTEX, PLAIN_FRAGMENT, { ink: { value: new Vector4() } }, true);
    this.#marks = new Mesh(geometry, this.#markMaterial);
    this.#add(this.#marks, 2);
  }

  /** Call ``draw`` while the surface is drawn with the numbers of leaves, or of faces in a partition, as colours. */
  withPickMaterial(draw: () => void): void {
    const others = [this.#wires, this.#borders, this.#concave, this.#marks, this.#original?.group].filter((one) => one?.visible) as Object3D[];
    for (const mesh of others) mesh.visible = false;
    this.#surfaceMesh.material = this.#pickMaterial;
    draw();
    this.#surfaceMesh.material = this.#surfaceMaterial;
    for (const mesh of others) mesh.visible = true;
  }

  dispose(): void {
    this.#leaves.dispose();
    this.#partition?.appearance.dispose();
    this.#original?.dispose();
    this.#geometry.dispose();
    this.#byFace?.dispose();
    for (const mesh of [this.#borders, this.#concave, this.#marks]) mesh?.geometry.dispose();
    for (const material of this.#materials) material.dispose();
    this.group.removeFromParent();
  }

  #lineMesh(lines: SurfaceLines): Mesh {
    const material = this.#material(
      LINE_VERTEX,
      LINE_FRAGMENT,
      {
        ink: { value: new Vector4() },
        selectedInk: { value: new Vector4() },
        pixels: { value: new Vector2(1, 1) },
        width: { value: 1 },
      },
      true,
    );
    return new Mesh(lineGeometry(lines), material);
  }

  #add(mesh: Mesh, order: number): void {
    mesh.frustumCulled = false;
    mesh.renderOrder = order;
    this.group.add(mesh);
    this.applyInks(this.#inks);
    this.resize(this.#size.width, this.#size.height, this.#size.ratio);
  }

  #material(
    vertexShader: string,
    fragmentShader: string,
    uniforms: Record<string, { value: unknown }>,
    isInk = false,
  ): RawShaderMaterial {
    const material = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader,
      fragmentShader,
      uniforms: {
        leaves: { value: this.appearance.texture },
        columns: { value: this.appearance.columns },
        ...uniforms,
      },
      side: DoubleSide, // the mesh may be open or inside out
      depthWrite: !isInk,
      transparent: isInk,
    });
    if (isInk) blendAsInk(material);
    this.#useAppearance(material, this.appearance);
    this.#materials.push(material);
    return material;
  }
}

/** Blend colours that are multiplied with their opacity. */
function blendAsInk(material: RawShaderMaterial): void {
  material.blending = CustomBlending;
  material.blendSrc = OneFactor;
  material.blendDst = OneMinusSrcAlphaFactor;
}

function surfaceGeometry(surface: Surface): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(surface.position, 3));
  geometry.setAttribute("normalAndLeaf", new BufferAttribute(surface.normalAndLeaf, 4));
  geometry.setIndex(new BufferAttribute(surface.index, 1));
  geometry.boundingSphere = new Sphere(new Vector3(...surface.centre), surface.radius);
  return geometry;
}

/** Return a geometry with vertices that no faces share, in the order of its faces. */
function unshared(geometry: BufferGeometry): BufferGeometry {
  const result = geometry.toNonIndexed();
  result.boundingSphere = geometry.boundingSphere;
  return result;
}

function lineGeometry(lines: SurfaceLines): InstancedBufferGeometry {
  const geometry = new InstancedBufferGeometry();
  const corners = new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, 1, 0]);
  geometry.setAttribute("position", new BufferAttribute(corners, 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  geometry.setAttribute("from", new InstancedBufferAttribute(every(lines.ends, 6, 0), 3));
  geometry.setAttribute("to", new InstancedBufferAttribute(every(lines.ends, 6, 3), 3));
  geometry.setAttribute("sides", new InstancedBufferAttribute(lines.leaves, 2));
  geometry.setAttribute("strength", new InstancedBufferAttribute(lines.strength, 1));
  geometry.instanceCount = lines.strength.length;
  return geometry;
}

/** Return three values of every ``stride`` values. */
function every(values: Float32Array, stride: number, start: number): Float32Array {
  const result = new Float32Array((values.length / stride) * 3);
  for (let i = 0, j = start; j < values.length; i += 3, j += stride) result.set(values.subarray(j, j + 3), i);
  return result;
}

function replaceGeometry(mesh: Mesh, geometry: BufferGeometry): void {
  mesh.geometry.dispose();
  mesh.geometry = geometry;
}

function setInk(mesh: Mesh | null, name: string, ink: readonly number[]): void {
  const uniform = (mesh?.material as RawShaderMaterial | undefined)?.uniforms[name];
  (uniform?.value as Vector4 | undefined)?.fromArray([...ink]);
}
