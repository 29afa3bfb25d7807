/** Any labels of the faces as parts: the tree of one step that shows them, as the service makes it of a revision. */

import type { Partition } from "./cleave-viewer";
import type { Model } from "./glb";
import { PartTree, type TreeNode } from "./tree";

/** Return the node of a part in a tree of one step: node 2 s + 2 is cut off the rest by split s, the rest is part 0. */
export function nodeOfPart(part: number, parts: number): number {
  return part > 0 ? 2 * part : Math.max(2 * parts - 3, 0);
}

/** Return the tree whose leaves are K parts with these areas and numbers of faces. */
function treeOfParts(areas: Float64Array, faces: Int32Array): PartTree {
  const count = areas.length;
  const leaf = { children: [], cutValue: null, step: null };
  const total = (values: ArrayLike<number>) => Array.from(values).reduce((sum, value) => sum + value, 0);
  const nodes: TreeNode[] = [{ ...leaf, id: 0, parent: -1, level: 1, label: 0, area: total(areas), faces: total(faces) }];
  for (let split = 0; split + 1 < count; split++) {
    const parent = Math.max(2 * split - 1, 0);
    const rest = nodes[parent]!;
    const below = { ...leaf, parent, level: split + 2 };
    const [area, many] = [areas[split + 1]!, faces[split + 1]!];
    nodes[parent] = { ...rest, children: [2 * split + 1, 2 * split + 2], step: 0 };
    nodes.push({ ...below, id: 2 * split + 1, label: 0, area: rest.area - area, faces: rest.faces - many });
    nodes.push({ ...below, id: 2 * split + 2, label: split + 1, area, faces: many });
  }
  return new PartTree(nodes);
}

/** The leaves of a tree, or the parts of a partition, as Appearance shows them. */
export interface PartitionedModel extends Pick<Model, "tree" | "leafNodes" | "palette"> {
  /** (3 L) area-weighted centre of every leaf. */
  readonly leafCentre: Float64Array;
  /** (L) area of every leaf. */
  readonly leafArea: Float64Array;
}

/** Return what shows a partition; ``faceOf`` has the face of the file of each drawn face. */
export function partitionModel(model: Model, faceOf: Uint32Array, { labels, colors }: Partition): PartitionedModel {
  const count = colors.length;
  const area = new Float64Array(count);
  const centre = new Float64Array(3 * count);
  const faces = new Int32Array(count);
  const { positions: p, index } = model;
  for (let drawn = 0; drawn < faceOf.length; drawn++) {
    const part = labels[faceOf[drawn]!]!;
    const [a, b, c] = [3 * index[3 * drawn]!, 3 * index[3 * drawn + 1]!, 3 * index[3 * drawn + 2]!];
    const [ux, uy, uz] = [p[b]! - p[a]!, p[b + 1]! - p[a + 1]!, p[b + 2]! - p[a + 2]!];
    const [vx, vy, vz] = [p[c]! - p[a]!, p[c + 1]! - p[a + 1]!, p[c + 2]! - p[a + 2]!];
    const own = Math.sqrt((uy * vz - uz * vy) ** 2 + (uz * vx - ux * vz) ** 2 + (ux * vy - uy * vx) ** 2) / 2;
    faces[part]!++;
    area[part]! += own;
    for (let k = 0; k < 3; k++) centre[3 * part + k]! += (own * (p[a + k]! + p[b + k]! + p[c + k]!)) / 3;
  }
  for (let i = 0; i < centre.length; i++) centre[i]! /= area[(i / 3) | 0]! || 1;
  return {
    tree: treeOfParts(area, faces),
    leafNodes: Array.from(colors, (_, part) => nodeOfPart(part, count)),
    palette: colors.map(channels),
    leafCentre: centre,
    leafArea: area,
  };
}

function channels(color: string): [number, number, number] {
  const value = Number.parseInt(color.slice(1), 16);
  return [(value >> 16) / 255, ((value >> 8) & 255) / 255, (value & 255) / 255];
}
