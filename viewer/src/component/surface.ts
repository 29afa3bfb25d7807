/** The drawn buffers: every vertex belongs to one leaf, so that each leaf has its own colour and offset. */

import type { Model } from "./glb";
import { cornerNormals, type CornerNormals } from "./normals";

export interface Surface {
  /** (3 W) xyz. */
  readonly position: Float32Array;
  /** (4 W) unit normal in 32767ths, and leaf. */
  readonly normalAndLeaf: Int16Array;
  /** (3 F) indices into the W vertices, sorted by leaf. */
  readonly index: Uint32Array;
  /** (3 F) the corners as welded vertices: equal for equal positions. */
  readonly welded: Uint32Array;
  /** (3 F) whether the vertex of the corner belongs to other leaves too. */
  readonly isShared: Uint8Array;
  /** (3 L) area-weighted centre of every leaf. */
  readonly leafCentre: Float64Array;
  /** (L) area of every leaf. */
  readonly leafArea: Float64Array;
  /** -1 if the faces are inside out, else 1. */
  readonly orientation: number;
  readonly centre: readonly [number, number, number];
  readonly radius: number;
}

const UNIT = 32767;

export async function buildSurface(model: Model, yieldToEventLoop: () => Promise<void>): Promise<Surface> {
  const { positions, index } = model;
  const representative = weld(positions, index.length / 3);
  const welded = representative === null ? index : index.map((vertex) => representative[vertex]!);
  await yieldToEventLoop();
  const { leafCentre, leafArea, volume } = faceSums(model);
  await yieldToEventLoop();
  const normals = await cornerNormals(model, welded, yieldToEventLoop);
  await yieldToEventLoop();
  const corners = splitByLeaf(model, welded, normals);
  await yieldToEventLoop();
  const { centre, radius } = bounds(positions, index);
  return {
    position: gather(positions, corners.source),
    normalAndLeaf: encode(normals.normals, corners.group, corners.leaf),
    index: corners.index,
    welded,
    isShared: corners.isShared,
    leafCentre,
    leafArea,
    orientation: volume < 0 ? -1 : 1,
    centre,
    radius,
  };
}

/** Return the first vertex at the position of each vertex; null if the faces share their vertices already. */
export function weld(positions: Float32Array, faces: number): Uint32Array | null {
  const count = positions.length / 3;
  if (count < 0.6 * faces) return null;
  const bits = new Uint32Array(positions.buffer, positions.byteOffset, positions.length);
  const size = 2 ** Math.ceil(Math.log2(2 * count + 1));
  const table = new Int32Array(size).fill(-1);
  const representative = new Uint32Array(count);
  for (let v = 0; v < count; v++) {
    let slot = hash(bits[3 * v]!, bits[3 * v + 1]!, bits[3 * v + 2]!) & (size - 1);
    for (;;) {
      const other = table[slot]!;
      if (other < 0) {
        table[slot] = v;
        representative[v] = v;
        break;
      }
      if (samePlace(positions, other, v)) {
        representative[v] = other;
        break;
      }
      slot = (slot + 1) & (size - 1);
    }
  }
  return representative;
}

function samePlace(positions: Float32Array, a: number, b: number): boolean {
  return (
    positions[3 * a] === positions[3 * b] &&
    positions[3 * a + 1] === positions[3 * b + 1] &&
    positions[3 * a + 2] === positions[3 * b + 2]
  );
}

function hash(a: number, b: number, c: number): number {
  let h = Math.imul(a, 0x9e3779b1) ^ Math.imul(b, 0x85ebca6b) ^ Math.imul(c, 0xc2b2ae35);
  h = Math.imul(h ^ (h >>> 15), 0x2c1b3c6d);
  return h ^ (h >>> 13);
}

/** Return sums over the faces: leaf centres weighted with area, leaf areas and the volume. */
function faceSums(model: Model) {
  const { positions: p, index, leafStart } = model;
  const leaves = leafStart.length - 1;
  const leafCentre = new Float64Array(3 * leaves);
  const leafArea = new Float64Array(leaves);
  const [ox, oy, oz] = [p[0] ?? 0, p[1] ?? 0, p[2] ?? 0];
  let volume = 0; // six times the enclosed volume
  for (let leaf = 0; leaf < leaves; leaf++) {
    let total = 0;
    let cx = 0;
    let cy = 0;
    let cz = 0;
    for (let i = 3 * leafStart[leaf]!; i < 3 * leafStart[leaf + 1]!; i += 3) {
      const a = 3 * index[i]!;
      const b = 3 * index[i + 1]!;
      const c = 3 * index[i + 2]!;
      const ux = p[b]! - p[a]!;
      const uy = p[b + 1]! - p[a + 1]!;
      const uz = p[b + 2]! - p[a + 2]!;
      const vx = p[c]! - p[a]!;
      const vy = p[c + 1]! - p[a + 1]!;
      const vz = p[c + 2]! - p[a + 2]!;
      const nx = uy * vz - uz * vy;
      const ny = uz * vx - ux * vz;
      const nz = ux * vy - uy * vx;
      const doubled = Math.sqrt(nx * nx + ny * ny + nz * nz);
      total += doubled;
      volume += nx * (p[a]! - ox) + ny * (p[a + 1]! - oy) + nz * (p[a + 2]! - oz);
      cx += doubled * (p[a]! + p[b]! + p[c]!);
      cy += doubled * (p[a + 1]! + p[b + 1]! + p[c + 1]!);
      cz += doubled * (p[a + 2]! + p[b + 2]! + p[c + 2]!);
    }
    const scale = total > 0 ? 1 / (3 * total) : 0;
    leafCentre.set([cx * scale, cy * scale, cz * scale], 3 * leaf);
    leafArea[leaf] = total / 2;
  }
  return { leafCentre, leafArea, volume };
}

/** Create one vertex for every pair of a leaf and a group of corners that it has. */
function splitByLeaf(model: Model, welded: Uint32Array, { group, normals }: CornerNormals) {
  const { index, leafStart } = model;
  const leaves = leafStart.length - 1;
  const owner = new Int32Array(normals.length / 3).fill(-1);
  const latest = new Int32Array(normals.length / 3);
  const firstLeafAt = new Int32Array(model.positions.length / 3).fill(-1); // by welded vertex
  const manyAt = new Uint8Array(firstLeafAt.length); // by welded vertex: whether several leaves meet
  const result = new Uint32Array(index.length);
  const source: number[] = [];
  const groups: number[] = [];
  const leafOf: number[] = [];
  for (let leaf = 0; leaf < leaves; leaf++) {
    for (let i = 3 * leafStart[leaf]!; i < 3 * leafStart[leaf + 1]!; i++) {
      const own = group[i]!;
      if (owner[own] !== leaf) {
        owner[own] = leaf;
        latest[own] = source.length;
        source.push(index[i]!);
        groups.push(own);
        leafOf.push(leaf);
        const place = welded[i]!;
        if (firstLeafAt[place] === -1) firstLeafAt[place] = leaf;
        else if (firstLeafAt[place] !== leaf) manyAt[place] = 1;
      }
      result[i] = latest[own]!;
    }
  }
  const isShared = new Uint8Array(index.length);
  for (let i = 0; i < index.length; i++) isShared[i] = manyAt[welded[i]!]!;
  return { index: result, source, group: groups, leaf: leafOf, isShared };
}

function gather(positions: Float32Array, source: readonly number[]): Float32Array {
  const result = new Float32Array(3 * source.length);
  source.forEach((vertex, i) => {
    result[3 * i] = positions[3 * vertex]!;
    result[3 * i + 1] = positions[3 * vertex + 1]!;
    result[3 * i + 2] = positions[3 * vertex + 2]!;
  });
  return result;
}

function encode(normals: Float32Array, groups: readonly number[], leaf: readonly number[]): Int16Array {
  const result = new Int16Array(4 * groups.length);
  groups.forEach((group, i) => {
    result[4 * i] = UNIT * normals[3 * group]!;
    result[4 * i + 1] = UNIT * normals[3 * group + 1]!;
    result[4 * i + 2] = UNIT * normals[3 * group + 2]!;
    result[4 * i + 3] = leaf[i]!;
  });
  return result;
}

function bounds(p: Float32Array, index: Uint32Array) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < index.length; i++) {
    for (let k = 0; k < 3; k++) {
      const value = p[3 * index[i]! + k]!;
      if (value < low[k]!) low[k] = value;
      if (value > high[k]!) high[k] = value;
    }
  }
  const centre: [number, number, number] = [0, 1, 2].map((k) => (low[k]! + high[k]!) / 2) as [number, number, number];
  const radius = Math.hypot(high[0]! - low[0]!, high[1]! - low[1]!, high[2]! - low[2]!) / 2;
  return { centre, radius: radius > 0 ? radius : 1 };
}
