/** Normals by crease for meshes of glTF that have none. */

import { BufferAttribute, Vector3, type BufferGeometry, type Material, type Matrix4, type Mesh } from "three";
import { cornerNormals } from "./normals";
import { weld } from "./surface";

interface Placed {
  readonly object: Mesh;
  readonly matrix: Matrix4;
}

/** Give meshes without normals those that the surface of all of them together has, so that borders of parts do not show. */
export async function round(placed: readonly Placed[], yieldToEventLoop: () => Promise<void>): Promise<void> {
  const bare = placed.filter(({ object }) => isBare(object));
  if (bare.length === 0) return;
  for (const { object } of bare) object.geometry = separated(object.geometry);
  const positions = joined(bare);
  const places = weld(positions, positions.length / 9);
  const index = new Uint32Array(positions.length / 3).map((_, i) => i);
  const welded = places ?? index;
  await yieldToEventLoop();
  const { group, normals } = await cornerNormals({ positions, normals: null, index }, welded, yieldToEventLoop);
  let from = 0;
  for (const { object, matrix } of bare) {
    const { count } = object.geometry.getAttribute("position");
    object.geometry.setAttribute("normal", localNormals(group.subarray(from, from + count), normals, matrix));
    for (const material of [object.material].flat()) smooth(material);
    from += count;
  }
}

function isBare({ isMesh, geometry }: Mesh): boolean {
  return isMesh && geometry.getAttribute("normal") === undefined; // not lines and points
}

/** Return the geometry with three vertices of its own for each face. */
function separated(geometry: BufferGeometry): BufferGeometry {
  return geometry.index === null ? geometry.clone() : geometry.toNonIndexed();
}

function joined(placed: readonly Placed[]): Float32Array {
  const count = placed.reduce((sum, { object }) => sum + object.geometry.getAttribute("position").count, 0);
  const result = new Float32Array(3 * count);
  const point = new Vector3();
  let at = 0;
  for (const { object, matrix } of placed) {
    const positions = object.geometry.getAttribute("position");
    for (let i = 0; i < positions.count; i++, at += 3) point.fromBufferAttribute(positions, i).applyMatrix4(matrix).toArray(result, at);
  }
  return result;
}

/** Return the normals of corners, turned back by the matrix of their mesh. */
function localNormals(group: Uint32Array, normals: Float32Array, matrix: Matrix4): BufferAttribute {
  // Normals turn with the inverse transpose; its inverse is the transpose.
  const back = matrix.clone().transpose();
  const result = new BufferAttribute(new Float32Array(3 * group.length), 3);
  const normal = new Vector3();
  group.forEach((at, i) => {
    normal.fromArray(normals, 3 * at).transformDirection(back);
    result.setXYZ(i, normal.x, normal.y, normal.z);
  });
  return result;
}

function smooth(material: Material): void {
  if ("flatShading" in material) material.flatShading = false;
}
