/** Line segments on the surface: borders of leaves and concave edges. */

import { forAdjacentCorners, next } from "./adjacency";
import type { Model } from "./glb";
import { faceNormals } from "./normals";
import type { Surface } from "./surface";

/** N line segments: ``ends`` (6 N) xyz, ``leaves`` (2 N) own and adjacent leaf, ``strength`` (N) opacity in 0..1. */
export interface SurfaceLines {
  readonly ends: Float32Array;
  readonly leaves: Float32Array;
  readonly strength: Float32Array;
}

const LEAST_ANGLE = (15 * Math.PI) / 180; // smaller angles are not drawn
const LEAST_COSINE = Math.cos(LEAST_ANGLE);
const FULL_ANGLE = (60 * Math.PI) / 180;
const MOST_LINES = 60_000;

/** Return pairs of corners, one after the other: the edges that two faces share. */
export function sharedEdges(welded: Uint32Array): Int32Array {
  const pairs = new Int32Array(welded.length); // an edge of two faces has two of the corners
  let count = 0;
  forAdjacentCorners(welded, null, (a, b) => {
    pairs[count++] = a;
    pairs[count++] = b;
  });
  return pairs.slice(0, count);
}

/** Return the edges between two parts, once for each side; ``parts`` has that of every face. */
export function partBorders(model: Model, edges: Int32Array, parts: Uint16Array): SurfaceLines {
  const kept: [number, number, number][] = [];
  for (let i = 0; i < edges.length; i += 2) {
    const [a, b] = [edges[i]!, edges[i + 1]!];
    const own = parts[(a / 3) | 0]!;
    const other = parts[(b / 3) | 0]!;
    if (own !== other) kept.push([a, own, other], [b, other, own]);
  }
  return lines(model, kept, () => 1);
}

/** Return the edges between two leaves, once for each side. */
export function borderLines(model: Model, surface: Surface): SurfaceLines {
  const leafOf = leafLookup(model);
  const kept: [number, number, number][] = [];
  forAdjacentCorners(surface.welded, surface.isShared, (a, b) => {
    const own = leafOf(a);
    const other = leafOf(b);
    if (own !== other) kept.push([a, own, other], [b, other, own]);
  });
  return lines(model, kept, () => 1);
}

/** Return the sharply concave edges; only the sharpest if there are more than MOST_LINES. ``parts`` replaces the leaves. */
export function concaveLines(model: Model, surface: Surface, parts?: Uint16Array): SurfaceLines {
  const normals = faceNormals(model);
  const found: { corner: number; angle: number }[] = [];
  forAdjacentCorners(surface.welded, null, (a, b) => {
    const angle = concaveAngle(model, normals, surface.orientation, a, b);
    if (angle >= LEAST_ANGLE) found.push({ corner: a, angle });
  });
  found.sort((one, other) => other.angle - one.angle);
  const leafOf = parts === undefined ? leafLookup(model) : (corner: number) => parts[(corner / 3) | 0]!;
  const kept = found.slice(0, MOST_LINES);
  return lines(
    model,
    kept.map(({ corner }) => [corner, leafOf(corner), -1]),
    (i) => Math.min(kept[i]!.angle / FULL_ANGLE, 1),
  );
}

/** Return the concave dihedral angle of the faces of two corners, in radians; 0 if the edge is convex. */
function concaveAngle(
  { positions: p, index }: Model,
  n: Float32Array,
  orientation: number,
  a: number,
  b: number,
): number {
  const i = a - (a % 3);
  const j = b - (b % 3);
  const cosine = n[i]! * n[j]! + n[i + 1]! * n[j + 1]! + n[i + 2]! * n[j + 2]!;
  if (!(cosine <= LEAST_COSINE)) return 0;
  const base = 3 * index[a]!;
  const tip = 3 * index[next(next(b))]!;
  const above =
    n[i]! * (p[tip]! - p[base]!) + n[i + 1]! * (p[tip + 1]! - p[base + 1]!) + n[i + 2]! * (p[tip + 2]! - p[base + 2]!);
  return orientation * above > 0 ? Math.acos(Math.max(cosine, -1)) : 0;
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
