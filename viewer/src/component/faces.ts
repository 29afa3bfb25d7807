/** The faces of a model in the order in which it stores them, for comparisons with labels of the input. */

import type { FaceTable } from "./cleave-viewer";
import type { Model } from "./glb";

export function faceTable({ positions, index, leafNodes, leafStart }: Model): FaceTable {
  const areas = new Float32Array(index.length / 3);
  const side = (from: number, to: number, k: number) => positions[3 * to + k]! - positions[3 * from + k]!;
  for (let face = 0; face < areas.length; face++) {
    const [a, b, c] = [index[3 * face]!, index[3 * face + 1]!, index[3 * face + 2]!];
    const [ux, uy, uz] = [side(a, b, 0), side(a, b, 1), side(a, b, 2)];
    const [vx, vy, vz] = [side(a, c, 0), side(a, c, 1), side(a, c, 2)];
    areas[face] = Math.hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx) / 2;
  }
  return { leafNodes, leafStart, areas };
}
