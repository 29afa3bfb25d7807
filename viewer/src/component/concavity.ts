/** Concavity of the surface at every drawn vertex. */

import type { Model } from "./glb";
import { normalize } from "./normals";
import type { Surface } from "./surface";

const LEAST = 1.2; // curvature times the radius of the model; less is not shown
const FULL = 6;

/**
 * Return (W) concavities, 0 to 255. The curvature along an edge from p to q with unit normals m and n is
 * (n - m) (q - p) / |q - p|^2. A vertex takes the least curvature of its edges, averaged once over its neighbours.
 */
export function vertexConcavity(model: Model, surface: Surface): Uint8Array {
  const { welded } = surface;
  const normals = vertexNormals(model, welded);
  const count = model.positions.length / 3;
  const least = new Float32Array(count);
  forEdges(welded, (a, b) => {
    const curvature = surface.orientation * curvatureAlong(model.positions, normals, a, b);
    if (curvature < least[a]!) least[a] = curvature;
    if (curvature < least[b]!) least[b] = curvature;
  });
  const sum = least.slice();
  const neighbours = new Float32Array(count).fill(1);
  forEdges(welded, (a, b) => {
    sum[a]! += least[b]!;
    sum[b]! += least[a]!;
    neighbours[a]!++;
    neighbours[b]!++;
  });
  const result = new Uint8Array(surface.position.length / 3);
  for (let corner = 0; corner < welded.length; corner++) {
    const vertex = welded[corner]!;
    const bent = (-surface.radius * sum[vertex]!) / neighbours[vertex]!;
    result[surface.index[corner]!] = 255 * Math.min(Math.max((bent - LEAST) / (FULL - LEAST), 0), 1);
  }
  return result;
}

/** Return (3 V) unit normals of the welded vertices: area-weighted sums over all their faces. */
function vertexNormals({ positions: p, index }: Model, welded: Uint32Array): Float32Array {
  const normals = new Float32Array(p.length);
  for (let i = 0; i < index.length; i += 3) {
    const a = 3 * index[i]!;
    const b = 3 * index[i + 1]!;
    const c = 3 * index[i + 2]!;
    const [ux, uy, uz] = [p[b]! - p[a]!, p[b + 1]! - p[a + 1]!, p[b + 2]! - p[a + 2]!];
    const [vx, vy, vz] = [p[c]! - p[a]!, p[c + 1]! - p[a + 1]!, p[c + 2]! - p[a + 2]!];
    const normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    for (let k = 0; k < 9; k++) normals[3 * welded[i + ((k / 3) | 0)]! + (k % 3)]! += normal[k % 3]!;
  }
  normalize(normals);
  return normals;
}

function forEdges(welded: Uint32Array, visit: (a: number, b: number) => void): void {
  for (let i = 0; i < welded.length; i += 3) {
    visit(welded[i]!, welded[i + 1]!);
    visit(welded[i + 1]!, welded[i + 2]!);
    visit(welded[i + 2]!, welded[i]!);
  }
}

function curvatureAlong(p: Float32Array, n: Float32Array, a: number, b: number): number {
  const i = 3 * a;
  const j = 3 * b;
  const x = p[j]! - p[i]!;
  const y = p[j + 1]! - p[i + 1]!;
  const z = p[j + 2]! - p[i + 2]!;
  const squared = x * x + y * y + z * z;
  if (squared === 0) return 0;
  return ((n[j]! - n[i]!) * x + (n[j + 1]! - n[i + 1]!) * y + (n[j + 2]! - n[i + 2]!) * z) / squared;
}
