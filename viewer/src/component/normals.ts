/** Normals of the corners of faces: those of the file, or smooth ones that end at creases. */

import { forAdjacentCorners, next } from "./adjacency";
import type { Model } from "./glb";

type Triangles = Pick<Model, "positions" | "normals" | "index">;

export interface CornerNormals {
  /** (3 F) group of every corner; the corners of a group share a vertex and a normal. */
  readonly group: Uint32Array;
  /** (3 G) unit normal of every group; zero if it has none. */
  readonly normals: Float32Array;
}

/**
 * Cosine of the angle between two faces from which their edge is a crease. Set by hand: modelling programs smooth up to
 * 30 to 40 degrees, and cylinders of 12 sides and more stay round.
 */
const CREASE = Math.cos((35 * Math.PI) / 180);

/**
 * Return the normals of the corners. Without normals in the file, the faces around a vertex are in one group if they are
 * connected by edges that are no creases, and its normal is the sum of theirs, weighted with area and angle.
 *
 * @param welded (3 F) vertices of the corners, equal for equal positions
 */
export async function cornerNormals(
  model: Triangles,
  welded: Uint32Array,
  yieldToEventLoop: () => Promise<void>,
): Promise<CornerNormals> {
  if (model.normals !== null) return { group: model.index, normals: model.normals };
  const faces = faceNormals(model);
  await yieldToEventLoop();
  const parent = new Int32Array(welded.length);
  for (let corner = 0; corner < parent.length; corner++) parent[corner] = corner;
  forAdjacentCorners(welded, null, (a, b) => {
    const i = a - (a % 3);
    const j = b - (b % 3);
    const cosine = faces[i]! * faces[j]! + faces[i + 1]! * faces[j + 1]! + faces[i + 2]! * faces[j + 2]!;
    if (!(cosine > CREASE)) return;
    const isSame = welded[a] === welded[b]; // direction of the edge: not if both faces have the same orientation
    join(parent, a, isSame ? b : next(b));
    join(parent, next(a), isSame ? next(b) : b);
  });
  await yieldToEventLoop();
  return summed(model, faces, parent);
}

/** Return (3 F) unit face normals; NaN for a face without area, so that its edges are creases and not concave. */
export function faceNormals({ positions: p, index }: Triangles): Float32Array {
  const normals = new Float32Array(index.length);
  for (let i = 0; i < index.length; i += 3) {
    const a = 3 * index[i]!;
    const b = 3 * index[i + 1]!;
    const c = 3 * index[i + 2]!;
    const [ux, uy, uz] = [p[b]! - p[a]!, p[b + 1]! - p[a + 1]!, p[b + 2]! - p[a + 2]!];
    const [vx, vy, vz] = [p[c]! - p[a]!, p[c + 1]! - p[a + 1]!, p[c + 2]! - p[a + 2]!];
    const x = uy * vz - uz * vy;
    const y = uz * vx - ux * vz;
    const z = ux * vy - uy * vx;
    const length = Math.sqrt(x * x + y * y + z * z);
    normals[i] = x / length;
    normals[i + 1] = y / length;
    normals[i + 2] = z / length;
  }
  return normals;
}

/** Return the root of a corner, and shorten the path to it. */
function root(parent: Int32Array, corner: number): number {
  while (parent[corner] !== corner) corner = parent[corner] = parent[parent[corner]!]!;
  return corner;
}

function join(parent: Int32Array, a: number, b: number): void {
  const from = root(parent, a);
  const to = root(parent, b);
  if (from < to) parent[to] = from;
  else parent[from] = to;
}

/** Number the groups of corners, and return the sums of their normals. */
function summed(model: Triangles, faces: Float32Array, parent: Int32Array): CornerNormals {
  const group = new Uint32Array(parent.length);
  let count = 0;
  for (let corner = 0; corner < parent.length; corner++) {
    const first = root(parent, corner); // the smallest of its group
    group[corner] = first === corner ? count++ : group[first]!;
  }
  const normals = new Float32Array(3 * count);
  const weights = new Float32Array(3);
  for (let i = 0; i < parent.length; i += 3) {
    if (!cornerWeights(model, i, weights)) continue;
    for (let k = 0; k < 3; k++) {
      const at = 3 * group[i + k]!;
      normals[at]! += weights[k]! * faces[i]!;
      normals[at + 1]! += weights[k]! * faces[i + 1]!;
      normals[at + 2]! += weights[k]! * faces[i + 2]!;
    }
  }
  normalize(normals);
  return { group, normals };
}

/** Write area times angle of the corners of a face; return false if it has no area. */
function cornerWeights({ positions: p, index }: Triangles, i: number, weights: Float32Array): boolean {
  const a = 3 * index[i]!;
  const b = 3 * index[i + 1]!;
  const c = 3 * index[i + 2]!;
  const [ux, uy, uz] = [p[b]! - p[a]!, p[b + 1]! - p[a + 1]!, p[b + 2]! - p[a + 2]!];
  const [vx, vy, vz] = [p[c]! - p[a]!, p[c + 1]! - p[a + 1]!, p[c + 2]! - p[a + 2]!];
  const [wx, wy, wz] = [vx - ux, vy - uy, vz - uz];
  const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  const area = Math.sqrt(x * x + y * y + z * z);
  if (!(area > 0)) return false;
  const atA = Math.atan2(area, ux * vx + uy * vy + uz * vz);
  const atB = Math.atan2(area, -(ux * wx + uy * wy + uz * wz));
  weights[0] = area * atA;
  weights[1] = area * atB;
  weights[2] = area * Math.max(Math.PI - atA - atB, 0);
  return true;
}

/** Normalize vectors in place; vectors of length 0 are kept. */
export function normalize(vectors: Float32Array): void {
  for (let i = 0; i < vectors.length; i += 3) {
    const length = Math.sqrt(vectors[i]! ** 2 + vectors[i + 1]! ** 2 + vectors[i + 2]! ** 2);
    const scale = length > 0 ? 1 / length : 0;
    vectors[i]! *= scale;
    vectors[i + 1]! *= scale;
    vectors[i + 2]! *= scale;
  }
}
