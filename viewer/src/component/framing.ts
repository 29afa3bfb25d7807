/** The part of space that some leaves fill, for the camera. */

import { Box3, Matrix4, Sphere, Vector3 } from "three";
import type { Drawing } from "./drawing";
import type { Surface } from "./surface";

/**
 * Return the sphere around the box of some leaves, as they are drawn; null if they have no faces. ``parts`` are those of the
 * drawn faces in a partition, whose leaves they are; null without one.
 */
export function sphereAround(
  drawing: Drawing,
  surface: Surface,
  leaves: ReadonlySet<number>,
  parts: Uint16Array | null,
): Sphere | null {
  const box = new Box3();
  const offsets = new Map([...leaves].map((leaf) => [leaf, drawing.appearance.stateOf(leaf).offset]));
  const { position, normalAndLeaf, index } = surface;
  const point = new Vector3();
  for (let corner = 0; corner < index.length; corner++) {
    const vertex = index[corner]!;
    const offset = offsets.get(parts === null ? normalAndLeaf[4 * vertex + 3]! : parts[(corner / 3) | 0]!);
    if (offset === undefined) continue;
    point.fromArray(position, 3 * vertex);
    box.expandByPoint(point.set(point.x + offset[0], point.y + offset[1], point.z + offset[2]));
  }
  if (box.isEmpty()) return null;
  drawing.group.updateWorldMatrix(true, false);
  return box.getBoundingSphere(new Sphere()).applyMatrix4(new Matrix4().copy(drawing.group.matrixWorld));
}
