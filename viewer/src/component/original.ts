/** The input with its own materials and textures, divided by part, as three.js objects. */

import {
  BufferAttribute,
  Group,
  Matrix4,
  Mesh,
  PMREMGenerator,
  SkinnedMesh,
  Vector3,
  type Material,
  type Object3D,
  type Texture,
  type WebGLRenderer,
} from "three";
import { RoomEnvironment } from "three/addons/environments/RoomEnvironment.js";
import { GLTFLoader, type GLTFParser } from "three/addons/loaders/GLTFLoader.js";
import type { Appearance } from "./appearance";
import type { Model } from "./glb";
import { round } from "./rounding";

interface Piece {
  readonly object: Mesh;
  /** From the vertices of the piece to the coordinates of the model. */
  readonly matrix: Matrix4;
  /** -1 if it has no faces. */
  readonly leaf: number;
}

const BLUR = 0.04; // of the surroundings, in radians, as three.js recommends for this room

/** Read a GLB file with all levels and everything of the input. Throws an Error with a reason. */
export async function readOriginal(
  data: ArrayBuffer,
  model: Model,
  yieldToEventLoop: () => Promise<void>,
): Promise<Original> {
  const { scene, parser } = await new GLTFLoader().parseAsync(data, "");
  scene.updateMatrixWorld(true);
  const leafOfLabel = new Map(model.leafNodes.map((node, leaf) => [model.tree.node(node).label, leaf]));
  const toModel = new Matrix4().fromArray([...model.placement]).invert();
  const poses = new Poses();
  const pieces: Piece[] = [];
  scene.traverse((object) => {
    if (!isDrawn(object)) return;
    const part = partOf(parser, object);
    const drawn = poses.still(object);
    pieces.push({
      object: drawn,
      matrix: toModel.clone().multiply(object.matrixWorld),
      leaf: part === undefined ? -1 : (leafOfLabel.get(part) ?? -1),
    });
  });
  if (pieces.every(({ leaf }) => leaf < 0)) throw new Error("It is not divided by part.");
  await round(pieces, yieldToEventLoop);
  return new Original(pieces);
}

interface Json {
  readonly nodes?: readonly { mesh?: number }[];
  readonly meshes?: readonly { primitives: readonly { extras?: { part?: number } }[] }[];
}

/**
 * Return the part in the extras of a primitive. The loader shares geometries, so theirs may be those of another one, and
 * it knows only the nodes of instanced meshes, which are in the order of the primitives.
 */
function partOf({ associations, json }: GLTFParser, object: Object3D): number | undefined {
  const own = associations.get(object);
  const node = own?.nodes ?? associations.get(object.parent!)?.nodes;
  const { nodes = [], meshes = [] } = json as Json;
  const mesh = own?.meshes ?? nodes[node ?? -1]?.mesh;
  const primitive = own?.primitives ?? (own?.nodes === undefined ? object.parent!.children.indexOf(object) : 0);
  return meshes[mesh ?? -1]?.primitives[primitive]?.extras?.part;
}

/** Return the surroundings that light the original materials. */
function surroundings(renderer: WebGLRenderer): Texture {
  const generator = new PMREMGenerator(renderer);
  const room = new RoomEnvironment();
  const { texture } = generator.fromScene(room, BLUR);
  room.dispose();
  generator.dispose();
  return texture;
}

export class Original {
  readonly group = new Group();
  readonly surroundings = surroundings;
  readonly #pieces: readonly Piece[];

  constructor(pieces: readonly Piece[]) {
    this.#pieces = pieces;
    for (const { object } of pieces) {
      object.matrixAutoUpdate = false;
      object.frustumCulled = false;
      this.group.add(object);
    }
  }

  /** Move and hide the pieces as their parts. */
  show(appearance: Appearance): void {
    const move = new Matrix4();
    for (const { object, matrix, leaf } of this.#pieces) {
      const { offset, isHidden } = leaf < 0 ? { offset: [0, 0, 0] as const, isHidden: false } : appearance.stateOf(leaf);
      object.visible = !isHidden;
      object.matrix.multiplyMatrices(move.makeTranslation(...offset), matrix);
    }
  }

  dispose(): void {
    const materials = new Set<Material>();
    for (const { object } of this.#pieces) {
      object.geometry.dispose();
      for (const material of [object.material].flat()) materials.add(material);
    }
    for (const material of materials) {
      for (const value of Object.values(material)) if (isTexture(value)) value.dispose();
      material.dispose();
    }
    this.group.removeFromParent();
  }
}

interface Pose {
  readonly position: BufferAttribute;
  readonly normal: BufferAttribute | null;
}

/** Applies skins and morph targets once: the pieces are then moved as a whole. The parts of a primitive share a pose. */
class Poses {
  readonly #known = new Map<string, Pose>();
  readonly #ids = new Map<unknown, number>();

  /** Return a mesh in its pose; itself if it has neither skin nor weights. */
  still(mesh: Mesh): Mesh {
    const isMorphed = mesh.morphTargetInfluences?.some((weight) => weight !== 0) ?? false;
    if (!(mesh instanceof SkinnedMesh) && !isMorphed) return mesh;
    const key = this.#keyOf(mesh);
    const pose = this.#known.get(key) ?? poseOf(mesh);
    this.#known.set(key, pose);
    const still = mesh.geometry.clone();
    still.morphAttributes = {};
    for (const name of ["skinIndex", "skinWeight"]) still.deleteAttribute(name);
    still.setAttribute("position", pose.position);
    if (pose.normal !== null) still.setAttribute("normal", pose.normal);
    return new Mesh(still, mesh.material);
  }

  /** Return a text that is equal if all that the pose depends on is equal. */
  #keyOf(mesh: Mesh): string {
    const { geometry, matrixWorld, morphTargetInfluences } = mesh;
    const attributes = ["position", "normal", "skinIndex", "skinWeight"].map((name) => geometry.getAttribute(name));
    const skeleton = mesh instanceof SkinnedMesh ? mesh.skeleton : null;
    const objects = [...attributes, skeleton, geometry.morphAttributes["position"]?.[0]].map((one) => this.#idOf(one));
    return [...objects, ...matrixWorld.elements, ...(morphTargetInfluences ?? [])].join();
  }

  #idOf(object: unknown): number {
    const id = this.#ids.get(object) ?? this.#ids.size;
    this.#ids.set(object, id);
    return id;
  }
}

function poseOf(mesh: Mesh): Pose {
  const normals = mesh.geometry.getAttribute("normal");
  const { count } = mesh.geometry.getAttribute("position");
  const position = new BufferAttribute(new Float32Array(3 * count), 3);
  const normal = normals !== undefined && mesh instanceof SkinnedMesh ? new BufferAttribute(new Float32Array(3 * count), 3) : null;
  const at = new Vector3();
  const tip = new Vector3();
  for (let i = 0; i < count; i++) {
    mesh.getVertexPosition(i, at);
    position.setXYZ(i, at.x, at.y, at.z);
    if (normal === null) continue;
    // Blended joints are an affine map: the difference of two points turns as the normal does.
    at.fromBufferAttribute(mesh.geometry.getAttribute("position"), i);
    tip.fromBufferAttribute(normals!, i).add(at);
    (mesh as SkinnedMesh).applyBoneTransform(i, at);
    (mesh as SkinnedMesh).applyBoneTransform(i, tip);
    tip.sub(at).normalize();
    normal.setXYZ(i, tip.x, tip.y, tip.z);
  }
  return { position, normal };
}

function isDrawn(object: Object3D): object is Mesh {
  return (object as Mesh).geometry !== undefined && (object as Mesh).material !== undefined;
}

function isTexture(value: unknown): value is Texture {
  return (value as Texture | null)?.isTexture === true;
}
