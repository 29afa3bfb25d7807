/** Reads the GLB files of the service: one POSITION accessor, and one slice of the index buffer per leaf. */

import { PartTree, type TreeNode } from "./tree";

export interface Model {
  readonly tree: PartTree;
  readonly automaticSegments: number;
  /** Whether the hierarchy ends at a limit although sensible cuts are left; null if that is not known. */
  readonly limitReached: boolean | null;
  /** (3 V) xyz of every vertex. */
  readonly positions: Float32Array;
  /** (3 V) unit normal of every vertex; null if the file has none. */
  readonly normals: Float32Array | null;
  /** (3 F) vertices of every face, sorted by leaf. */
  readonly index: Uint32Array;
  /** (F) number in the file that was sent of every face; null if the file is from before these were written. */
  readonly inputFaces: Uint32Array | null;
  /** (L) tree node of every leaf. */
  readonly leafNodes: readonly number[];
  /** (L + 1) leaf i has the faces leafStart[i] to leafStart[i + 1] - 1. */
  readonly leafStart: readonly number[];
  /** (16) matrix by columns from these positions to the scene of the file. */
  readonly placement: readonly number[];
  /** sRGB colour of every label, in 0..1. */
  readonly palette: readonly (readonly [number, number, number])[];
}

/** The data is not a GLB file of the service; the message names the fault. */
export class InvalidModel extends Error {}

interface GltfNode {
  mesh?: number;
  children?: number[];
  translation?: number[];
  rotation?: number[];
  scale?: number[];
  extras: Record<string, number | null>;
}

interface GltfDocument {
  nodes: GltfNode[];
  scenes: { extras: Record<string, unknown> }[];
  meshes: { primitives: { attributes: { POSITION: number; NORMAL?: number }; indices: number; material: number }[] }[];
  materials: { pbrMetallicRoughness: { baseColorFactor: number[] } }[];
  accessors: { bufferView: number; byteOffset?: number; count: number }[];
  bufferViews: { byteOffset?: number; byteLength: number }[];
}

const MAGIC = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const WORD = 4;

export function parseModel(data: ArrayBuffer): Model {
  const { document, binary } = chunks(data);
  try {
    return modelOf(document, data, binary);
  } catch (error) {
    if (error instanceof InvalidModel) throw error;
    throw new InvalidModel("The GLB file was not written by Cleave: load the model.glb of a job.");
  }
}

function chunks(data: ArrayBuffer): { document: GltfDocument; binary: number } {
  const view = new DataView(data);
  if (data.byteLength < 28 || view.getUint32(0, true) !== MAGIC || view.getUint32(8, true) !== data.byteLength)
    throw new InvalidModel("The GLB file is incomplete: load it again.");
  const length = view.getUint32(12, true);
  if (view.getUint32(16, true) !== JSON_CHUNK || 28 + length > data.byteLength)
    throw new InvalidModel("The GLB file is incomplete: load it again.");
  const text = new TextDecoder().decode(new Uint8Array(data, 20, length));
  return { document: JSON.parse(text) as GltfDocument, binary: 28 + length };
}

function modelOf(document: GltfDocument, data: ArrayBuffer, binary: number): Model {
  const extras = document.scenes[0]?.extras ?? {};
  const leaves = document.nodes.flatMap(({ mesh, extras: { node } }, i) => (mesh === undefined ? [] : [{ id: node ?? i, mesh }]));
  const primitives = leaves.map(({ mesh }) => at(at(document.meshes, mesh).primitives, 0));
  const starts = primitives.map(({ indices }) => (at(document.accessors, indices).byteOffset ?? 0) / (3 * WORD));
  const order = leaves.map((_, i) => i).sort((a, b) => at(starts, a) - at(starts, b));
  const indexView = at(document.bufferViews, at(document.accessors, at(primitives, 0).indices).bufferView);
  const vectors = (accessor: number) => {
    const { bufferView, count } = at(document.accessors, accessor);
    return new Float32Array(data, binary + (at(document.bufferViews, bufferView).byteOffset ?? 0), 3 * count);
  };
  const { POSITION, NORMAL } = at(primitives, 0).attributes;
  const { automatic_segments: automatic, limit_reached: limit, input_faces: faces } = extras;
  return {
    tree: new PartTree(isSplits(extras) ? nodesOfSplits(extras, document) : document.nodes.map((_, id) => treeNode(document, id))),
    automaticSegments: typeof automatic === "number" ? automatic : leaves.length,
    limitReached: typeof limit === "boolean" ? limit : null,
    positions: vectors(POSITION),
    normals: NORMAL === undefined ? null : vectors(NORMAL),
    index: new Uint32Array(data, binary + (indexView.byteOffset ?? 0), indexView.byteLength / WORD),
    inputFaces: isView(faces) ? new Uint32Array(data, binary + (at(document.bufferViews, faces.bufferView).byteOffset ?? 0), faces.count) : null,
    leafNodes: order.map((i) => at(leaves, i).id),
    leafStart: [...order.map((i) => at(starts, i)), indexView.byteLength / (3 * WORD)],
    placement: matrixOf(at(document.nodes, 0)),
    palette: document.materials.map((material) => srgb(material.pbrMetallicRoughness.baseColorFactor)),
  };
}

function isView(value: unknown): value is { bufferView: number; count: number } {
  return typeof value === "object" && value !== null && "bufferView" in value && "count" in value;
}

/** The splits of the levels that a file has, in the extras of its scene. */
interface Splits {
  split_node: number[];
  step: number[];
  cut_value: (number | null)[];
}

function isSplits(extras: object): extras is Splits {
  return ["split_node", "step", "cut_value"].every((name) => Array.isArray((extras as Record<string, unknown>)[name]));
}

/** Return the nodes of the binary tree; those of the file are the ones of the n-ary tree. */
function nodesOfSplits({ split_node, step, cut_value }: Splits, document: GltfDocument): TreeNode[] {
  const given = new Map(document.nodes.map(({ extras }) => [extras["node"], extras]));
  const leaf = { children: [], area: 0, faces: 0, cutValue: null, step: null };
  const nodes: Writable<TreeNode>[] = [{ ...leaf, id: 0, parent: -1, level: 1, label: 0 }];
  split_node.forEach((cut, split) => {
    const parent = at(nodes, cut);
    for (const id of [2 * split + 1, 2 * split + 2]) {
      const label = id % 2 === 1 ? parent.label : split + 1;
      nodes.push({ ...leaf, id, parent: cut, level: split + 2, label });
    }
    parent.children = [2 * split + 1, 2 * split + 2];
    parent.cutValue = cut_value[split] ?? null;
    parent.step = at(step, split);
  });
  for (const node of nodes.toReversed()) {
    const extras = given.get(node.id);
    const below = node.children.map((child) => at(nodes, child));
    node.area = Number(extras?.["area"] ?? below.reduce((sum, child) => sum + child.area, 0));
    node.faces = Number(extras?.["faces"] ?? below.reduce((sum, child) => sum + child.faces, 0));
  }
  return nodes;
}

type Writable<T> = { -readonly [name in keyof T]: T[name] };

/** Return a node of a file from before there were steps, whose nodes are those of the binary tree. */
function treeNode(document: GltfDocument, id: number): TreeNode {
  const { extras, children } = at(document.nodes, id);
  const parent = id === 0 ? -1 : document.nodes.findIndex((node) => node.children?.includes(id));
  if (id > 0 && parent < 0) throw new InvalidModel("The nodes of the GLB file do not form a tree: load the file again.");
  return {
    id,
    parent,
    children: children ?? [],
    level: Number(extras["level"]),
    label: Number(extras["label"] ?? extras["segment"] ?? 0),
    area: Number(extras["area"]),
    faces: Number(extras["faces"]),
    cutValue: extras["cut_value"] ?? null,
    step: children === undefined ? null : Math.min(...children),
  };
}

/** Return the matrix of a node, by columns. */
function matrixOf({ translation: t = [0, 0, 0], rotation: q = [0, 0, 0, 1], scale: s = [1, 1, 1] }: GltfNode): number[] {
  const [x, y, z, w] = q as [number, number, number, number];
  const columns = [
    [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
    [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
    [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
  ];
  return [...columns.flatMap((column, k) => [...column.map((value) => value * s[k]!), 0]), ...t, 1];
}

/** Convert a linear colour of glTF to sRGB (IEC 61966-2-1). */
function srgb(linear: readonly number[]): readonly [number, number, number] {
  const encode = (value = 0) => (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055);
  return [encode(linear[0]), encode(linear[1]), encode(linear[2])];
}

function at<T>(values: readonly T[], i: number): T {
  const value = values[i];
  if (value === undefined) throw new InvalidModel("The GLB file refers to an element that it does not contain.");
  return value;
}
