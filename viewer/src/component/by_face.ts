/** Buffers with three vertices for each face, so that the shaders can look up the part of the face of a vertex. */

import { BufferAttribute, BufferGeometry, Sphere, Vector3 } from "three";
import type { Surface } from "./surface";

/** Return the surface with unshared vertices, in the order of its faces. */
export function byFaceGeometry({ position, normalAndLeaf, index, centre, radius }: Surface): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(gathered(position, 3, index), 3));
  geometry.setAttribute("normalAndLeaf", new BufferAttribute(gathered(normalAndLeaf, 4, index), 4));
  geometry.boundingSphere = new Sphere(new Vector3(...centre), radius);
  return geometry;
}

/** Return the values of vertices, ``size`` each, at the corners of the faces. */
export function gathered<T extends Float32Array | Int16Array | Uint8Array>(values: T, size: number, index: Uint32Array): T {
  const result = new (values.constructor as new (length: number) => T)(size * index.length);
  for (let i = 0; i < index.length; i++) {
    const from = size * index[i]!;
    for (let k = 0; k < size; k++) result[size * i + k] = values[from + k]!;
  }
  return result;
}
