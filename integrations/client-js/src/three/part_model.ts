/** The parts of a `model.glb`, at every level that the file has. */

import { Color, DoubleSide, MeshStandardMaterial, type Material, type Mesh, type Object3D } from "three";
import { PartTree } from "../tree.js";

/** What GLTFLoader returns. */
export interface GltfFile {
  readonly scene: Object3D;
  readonly parser: { readonly json: unknown };
}

/** An intersection of three.js, or an event of react-three-fiber. */
export interface Hit {
  readonly object: Object3D;
  readonly faceIndex?: number | null | undefined;
}

/** A part at the level that is shown. */
export interface Part {
  /** Its node of the hierarchy: a part that is not split by a finer level keeps it. */
  readonly node: number;
  /** Its number, 0 to segments - 1, as in labels and files. */
  readonly label: number;
  /** As in files: `segment 3`, or the name that the part was given. */
  readonly name: string;
  /** In the order of the file. */
  readonly meshes: readonly Mesh[];
}

/** The material of a part; null for its own one. */
export type Paint = (part: Part) => Material | null;

/** A mesh of the file, which is in one part at every level. */
interface Piece {
  /** At the last level of the file. */
  readonly label: number;
  readonly name: string | undefined;
  /** In a file with `?keep=all`; null for the colour of the part. */
  readonly material: Mesh["material"] | null;
}

interface GltfJson {
  readonly materials?: readonly { readonly pbrMetallicRoughness?: { readonly baseColorFactor?: readonly number[] } }[];
}

export class PartModel {
  readonly tree: PartTree;
  /** The number of parts that Cleave chooses. */
  readonly automaticSegments: number;
  /** Whether the file has no normals, so that materials need `flatShading: true`. */
  readonly isFlat: boolean;
  readonly #pieces = new Map<Object3D, Piece>();
  readonly #materials: readonly Material[]; // of the labels
  #paint: Paint = () => null;
  #segments = 0;
  #parts: readonly Part[] = [];

  /**
   * @param gltf what GLTFLoader has made of a `model.glb`; with `?levels=all` it has every level
   * @throws TypeError if the file is not one that Cleave has written
   */
  constructor(gltf: GltfFile) {
    const { split_node: splits, automatic_segments: automatic, segments } = gltf.scene.userData;
    if (!Array.isArray(splits)) throw new TypeError("The file was not written by Cleave: load the model.glb of a job.");
    this.tree = new PartTree(splits as number[]);
    this.automaticSegments = Number(automatic);
    gltf.scene.traverse((object) => {
      const piece = isMesh(object) ? pieceOf(object) : null;
      if (piece !== null) this.#pieces.set(object, piece);
    });
    this.isFlat = [...this.#pieces.keys()].every((object) => !(object as Mesh).geometry.hasAttribute("normal"));
    this.#materials = materialsOf(gltf.parser.json as GltfJson, this.isFlat);
    this.segments = Number(segments);
  }

  /** The number of parts that is shown, 1 to `tree.maxSegments`; to be set for another level. */
  get segments(): number {
    return this.#segments;
  }

  set segments(segments: number) {
    this.#parts = this.#partsAt(segments);
    this.#segments = segments;
    this.repaint();
  }

  /** The parts of the level that is shown, in the order of their labels. */
  get parts(): readonly Part[] {
    return this.#parts;
  }

  /** Return the part that a ray has hit; null if it has hit something else. */
  partOf({ object }: Hit): Part | null {
    const piece = this.#pieces.get(object);
    return piece === undefined ? null : (this.#parts[this.tree.labelAt(piece.label, this.#segments)] ?? null);
  }

  /** Return the nodes of a part and of what it was cut from, from the part to the whole mesh. */
  ancestry(part: Part): number[] {
    const nodes = [];
    for (let node = part.node; node >= 0; node = this.tree.parentOf(node)) nodes.push(node);
    return nodes;
  }

  /** Let a function choose the materials of parts, now and at every change of the level. */
  paint(paint: Paint): void {
    this.#paint = paint;
    this.repaint();
  }

  /** Ask the function of `paint` for all materials again. */
  repaint(): void {
    for (const part of this.#parts) {
      const painted = this.#paint(part);
      for (const mesh of part.meshes) {
        const material = painted ?? this.#pieces.get(mesh)?.material ?? this.#materials[part.label];
        if (material !== undefined) mesh.material = material;
      }
    }
  }

  #partsAt(segments: number): Part[] {
    const nodes = this.tree.parts(segments);
    const meshes: Mesh[][] = nodes.map(() => []);
    for (const [object, { label }] of this.#pieces) meshes[this.tree.labelAt(label, segments)]?.push(object as Mesh);
    return nodes.map((node, label) => ({ node, label, name: this.#nameOf(label, meshes[label]), meshes: meshes[label] ?? [] }));
  }

  /** Only parts that no level of the file splits have names; parts of several pieces may be split. */
  #nameOf(label: number, meshes: readonly Mesh[] = []): string {
    const pieces = meshes.map((mesh) => this.#pieces.get(mesh));
    const isWhole = pieces.every((piece) => piece?.label === label);
    return (isWhole ? pieces[0]?.name : undefined) ?? `segment ${label}`;
  }
}

function isMesh(object: Object3D): object is Mesh {
  return "isMesh" in object;
}

/** Return what the file says about a mesh; null if it is in no part. */
function pieceOf({ geometry, userData, material }: Mesh): Piece | null {
  const isKept = geometry.userData["part"] !== undefined;
  const label: unknown = isKept ? geometry.userData["part"] : userData["label"];
  const name: unknown = isKept ? geometry.userData["name"] : userData["name"];
  if (typeof label !== "number") return null;
  return { label, name: typeof name === "string" ? name : undefined, material: isKept ? material : null };
}

/** Return the materials of the labels, in the colours of the file. */
function materialsOf({ materials = [] }: GltfJson, flatShading: boolean): Material[] {
  return materials.map(({ pbrMetallicRoughness }) => {
    const [red = 1, green = 1, blue = 1] = pbrMetallicRoughness?.baseColorFactor ?? [];
    return new MeshStandardMaterial({ color: new Color().setRGB(red, green, blue), roughness: 0.8, side: DoubleSide, flatShading });
  });
}
