/** A coarse model of a large one, which is drawn first: the vertices in each cell of a grid become one. */

import type { Model } from "./glb";

const CELLS = 12_000; // that the area of the surface has; a quarter or so more are occupied, with two faces each
const MOST_CELLS = 2 ** 16; // along an axis, so that the number of a cell is a safe integer

/** Return the model with the faces whose corners are in different cells, in the order of the given one. */
export function coarseModel(model: Model): Model {
  const { cellOf, positions } = clustered(model);
  const { index, leafStart } = model;
  const kept = new Uint32Array(index.length);
  const starts = [0];
  let count = 0;
  for (let leaf = 0; leaf + 1 < leafStart.length; leaf++) {
    for (let i = 3 * leafStart[leaf]!; i < 3 * leafStart[leaf + 1]!; i += 3) {
      const a = cellOf[index[i]!]!;
      const b = cellOf[index[i + 1]!]!;
      const c = cellOf[index[i + 2]!]!;
      if (a === b || b === c || c === a) continue;
      kept[count++] = a;
      kept[count++] = b;
      kept[count++] = c;
    }
    starts.push(count / 3);
  }
  return { ...model, positions, normals: null, index: kept.slice(0, count), inputFaces: null, leafStart: starts };
}

/** Return the number of the cell of every vertex, and the mean of the vertices of each cell. */
function clustered(model: Model): { cellOf: Uint32Array; positions: Float32Array } {
  const { positions: p } = model;
  const vertices = p.length / 3;
  const { low, size, across } = gridOf(model);
  const slots = 2 ** Math.ceil(Math.log2(2 * vertices + 1));
  const numberAt = new Int32Array(slots).fill(-1);
  const keyAt = new Float64Array(slots);
  const cellOf = new Uint32Array(vertices);
  const sums = new Float64Array(3 * vertices);
  const counts = new Uint32Array(vertices);
  let cells = 0;
  for (let v = 0; v < vertices; v++) {
    const x = Math.floor((p[3 * v]! - low[0]) / size);
    const y = Math.floor((p[3 * v + 1]! - low[1]) / size);
    const z = Math.floor((p[3 * v + 2]! - low[2]) / size);
    const key = x + across * (y + across * z);
    let slot = (Math.imul(x, 0x9e3779b1) ^ Math.imul(y, 0x85ebca6b) ^ Math.imul(z, 0xc2b2ae35)) & (slots - 1);
    while (numberAt[slot]! >= 0 && keyAt[slot] !== key) slot = (slot + 1) & (slots - 1);
    if (numberAt[slot]! < 0) {
      numberAt[slot] = cells++;
      keyAt[slot] = key;
    }
    const cell = (cellOf[v] = numberAt[slot]!);
    for (let k = 0; k < 3; k++) sums[3 * cell + k]! += p[3 * v + k]!;
    counts[cell]!++;
  }
  const positions = new Float32Array(3 * cells);
  for (let i = 0; i < positions.length; i++) positions[i] = sums[i]! / counts[Math.floor(i / 3)]!;
  return { cellOf, positions };
}

/** Return a grid whose cells are as large as the area of the surface divided by CELLS. */
function gridOf({ positions: p, index }: Model): { low: [number, number, number]; size: number; across: number } {
  const low: [number, number, number] = [Infinity, Infinity, Infinity];
  let extent = 0;
  for (let k = 0; k < 3; k++) {
    let most = -Infinity;
    for (let i = k; i < p.length; i += 3) {
      if (p[i]! < low[k]!) low[k] = p[i]!;
      if (p[i]! > most) most = p[i]!;
    }
    extent = Math.max(extent, most - low[k]!);
  }
  let area = 0;
  for (let i = 0; i < index.length; i += 3) {
    const [a, b, c] = [3 * index[i]!, 3 * index[i + 1]!, 3 * index[i + 2]!];
    const [ux, uy, uz] = [p[b]! - p[a]!, p[b + 1]! - p[a + 1]!, p[b + 2]! - p[a + 2]!];
    const [vx, vy, vz] = [p[c]! - p[a]!, p[c + 1]! - p[a + 1]!, p[c + 2]! - p[a + 2]!];
    area += Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
  }
  const size = Math.max(Math.sqrt(area / CELLS), extent / MOST_CELLS) || 1;
  return { low, size, across: Math.floor(extent / size) + 1 };
}
