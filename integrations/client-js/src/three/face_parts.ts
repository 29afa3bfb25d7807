/** Parts of a geometry of your own: any one whose triangles are those of the file that was sent, in its order. */

import { BufferAttribute, Color, type BufferGeometry, type ColorRepresentation } from "three";
import type { PartTree } from "../tree.js";
import type { Hit } from "./part_model.js";

export class FaceParts {
  /**
   * @param labels of all faces at the last level: `await cleave.labels(id, { segments: tree.maxSegments })`
   */
  constructor(
    readonly tree: PartTree,
    readonly labels: Int32Array,
  ) {}

  /** Return the label of the part that a ray has hit, at a level; -1 if it has hit no face. */
  partOf({ faceIndex }: Hit, segments: number): number {
    const label = faceIndex == null ? undefined : this.labels[faceIndex];
    return label === undefined ? -1 : this.tree.labelAt(label, segments);
  }

  /** Return the labels of all faces at a level. No request is needed. */
  at(segments: number): Int32Array {
    return this.tree.labelsAt(this.labels, segments);
  }
}

/**
 * Colour the faces of a geometry by their labels, for a material with `vertexColors: true`.
 *
 * @throws RangeError if the geometry has an index, which `toNonIndexed()` resolves, or another number of faces
 */
export function colorFaces(geometry: BufferGeometry, labels: Int32Array, colorOf: (label: number) => ColorRepresentation): void {
  const corners = geometry.getAttribute("position").count;
  if (geometry.index !== null) throw new RangeError("Faces of an indexed geometry share their vertices: use geometry.toNonIndexed().");
  if (corners !== 3 * labels.length) throw new RangeError(`The geometry has ${corners / 3} faces, and there are labels of ${labels.length}.`);
  const colors = new Float32Array(3 * corners);
  const color = new Color();
  labels.forEach((label, face) => {
    color.set(colorOf(label));
    for (let corner = 3 * face; corner < 3 * face + 3; corner++) color.toArray(colors, 3 * corner);
  });
  geometry.setAttribute("color", new BufferAttribute(colors, 3));
}
