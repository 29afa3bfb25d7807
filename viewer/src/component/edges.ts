/** Lines on the surface: where leaves meet, and where it is concave. */

import type { Model } from "./glb";
import type { Surface } from "./surface";

/** Line segments, each seen from one leaf: ``ends`` (6 N), ``leaves`` (2 N) own and other, ``strength`` (N) in 0..1. */
export interface SurfaceLines {
  readonly ends: Float32Array;
  readonly leaves: Float32Array;
  readonly strength: Float32Array;
}

const LEAST_ANGLE = (15 * Math.PI) / 180; // less is the roundness of a mesh
const FULL_ANGLE = (70 * Math.PI) / 180;
const MOST_LINES = 60_000;

/** The edges between two leaves, once from each side. */
export function borderLines(model: Model, surface: Surface): SurfaceLines {
  const { isShared } = surface;
  const pairs = adjacentCorners(surface.welded, (i, j) => isShared[i] === 1 && isShared[j] === 1);
  const leafOf = leafLookup(model);
  const kept: [number, number, number][] = [];
  for (const [a, b] of pairs) {
    const own = leafOf(a);
    const other = leafOf(b);
    if (own !== other) kept.push([a, own, other], [b, other, own]);
  }
  return lines(model, kept, () => 1);
}

/** The edges at which the surface is bent inwards, the sharpest ones where there are very many. */
export function concaveLines(model: Model, surface: Surface): SurfaceLines {
  const leafOf = leafLookup(model);
  const kept: [number, number, number][] = [];
  const angles: number[] = [];
  for (const [a, b] of adjacentCorners(surface.welded, () => true)) {
    const angle = concavity(model, a, b);
    if (angle < LEAST_ANGLE) continue;
    kept.push([a, leafOf(a), -1]);
    angles.push(angle);
  }
  const order = kept.map((_, i) => i).sort((i, j) => angles[j]! - angles[i]!);
  const chosen = order.slice(0, MOST_LINES);
  const strength = (i: number) => Math.min(angles[chosen[i]!]! / FULL_ANGLE, 1);
  return lines(
    model,
    chosen.map((i) => kept[i]!),
    strength,
  );
}

/** Corner i begins the edge to the next corner of its face; the pairs are the edges of two faces. */
function adjacentCorners(welded: Uint32Array, isWanted: (i: number, j: number) => boolean): [number, number][] {
  const wanted: number[] = [];
  for (let i = 0; i < welded.length; i++) if (isWanted(i, next(i))) wanted.push(i);
  const size = 2 ** Math.ceil(Math.log2(2 * wanted.length + 1));
  const table = new Int32Array(size).fill(-1);
  const pairs: [number, number][] = [];
  for (const i of wanted) {
    const low = Math.min(welded[i]!, welded[next(i)]!);
    const high = Math.max(welded[i]!, welded[next(i)]!);
    let slot = (Math.imul(low, 0x9e3779b1) ^ Math.imul(high, 0x85ebca6b)) & (size - 1);
    for (;;) {
      const other = table[slot]!;
      if (other < 0) {
        table[slot] = i;
        break;
      }
      const a = welded[other]!;
      const b = welded[next(other)]!;
      if (Math.min(a, b) === low && Math.max(a, b) === high) {
        pairs.push([other, i]);
        break;
      }
      slot = (slot + 1) & (size - 1);
    }
  }
  return pairs;
}

function next(corner: number): number {
  return corner % 3 === 2 ? corner - 2 : corner + 1;
}

/** How far the faces of two corners of an edge are bent inwards, in radians; 0 where they are not. */
function concavity(model: Model, a: number, b: number): number {
  const first = normal(model, a);
  const second = normal(model, b);
  const length = Math.hypot(...first) * Math.hypot(...second);
  if (length === 0) return 0;
  const cosine = (first[0] * second[0] + first[1] * second[1] + first[2] * second[2]) / length;
  const angle = Math.acos(Math.min(Math.max(cosine, -1), 1));
  const { positions: p, index } = model;
  const base = 3 * index[a]!;
  const tip = 3 * index[next(next(b))]!;
  const above =
    first[0] * (p[tip]! - p[base]!) + first[1] * (p[tip + 1]! - p[base + 1]!) + first[2] * (p[tip + 2]! - p[base + 2]!);
  return above > 0 ? angle : 0;
}

function normal(model: Model, corner: number): [number, number, number] {
  const { positions: p, index } = model;
  const first = corner - (corner % 3);
  const [a, b, c] = [3 * index[first]!, 3 * index[first + 1]!, 3 * index[first + 2]!];
  const u = [p[b]! - p[a]!, p[b + 1]! - p[a + 1]!, p[b + 2]! - p[a + 2]!] as const;
  const v = [p[c]! - p[a]!, p[c + 1]! - p[a + 1]!, p[c + 2]! - p[a + 2]!] as const;
  return [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
}

function leafLookup(model: Model): (corner: number) => number {
  const { leafStart } = model;
  const leafOfFace = new Uint16Array(model.index.length / 3);
  for (let leaf = 0; leaf + 1 < leafStart.length; leaf++) leafOfFace.fill(leaf, leafStart[leaf], leafStart[leaf + 1]);
  return (corner) => leafOfFace[(corner / 3) | 0]!;
}

function lines(
  model: Model,
  kept: readonly (readonly [corner: number, own: number, other: number])[],
  strength: (i: number) => number,
): SurfaceLines {
  const { positions, index } = model;
  const result = {
    ends: new Float32Array(6 * kept.length),
    leaves: new Float32Array(2 * kept.length),
    strength: new Float32Array(kept.length),
  };
  kept.forEach(([corner, own, other], i) => {
    const from = 3 * index[corner]!;
    const to = 3 * index[next(corner)]!;
    result.ends.set(positions.subarray(from, from + 3), 6 * i);
    result.ends.set(positions.subarray(to, to + 3), 6 * i + 3);
    result.leaves[2 * i] = own;
    result.leaves[2 * i + 1] = other;
    result.strength[i] = strength(i);
  });
  return result;
}
