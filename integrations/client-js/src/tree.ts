/** The parts of a mesh at every level, from the splits of the hierarchy. */

import type { components } from "./schema.js";

/**
 * The tree of cuts. Split s cuts a node in two, the nodes 2 s + 1 and 2 s + 2, and so leads from s + 1 to s + 2 segments.
 * The first of the two keeps the label, the other one has the label s + 1.
 */
export class PartTree {
  /** The largest number of segments. */
  readonly maxSegments: number;
  readonly #labels: number[] = [0]; // of the nodes
  readonly #parents: number[] = [-1];

  /** @param splitNodes node that each split cuts, as `split_node` in the extras of a GLB file */
  constructor(readonly splitNodes: readonly number[]) {
    this.maxSegments = splitNodes.length + 1;
    splitNodes.forEach((node, split) => {
      const label = this.#labels[node];
      if (label === undefined) throw new RangeError(`Split ${split} cuts node ${node}, which no earlier split has made.`);
      this.#labels.push(label, split + 1);
      this.#parents.push(node, node);
    });
  }

  /** Return the tree of a hierarchy, as `Cleave.hierarchy` returns it. */
  static of(hierarchy: components["schemas"]["HierarchyDocument"]): PartTree {
    return new PartTree(hierarchy.curve.map(({ node }) => node));
  }

  /** Return the label of a node at every level at which it is a part. */
  labelOf(node: number): number {
    return at(this.#labels, node);
  }

  /** Return the node that a node was cut from; -1 for the whole mesh. */
  parentOf(node: number): number {
    return at(this.#parents, node);
  }

  /** Return the nodes that are parts at a level, in the order of their labels. */
  parts(segments: number): number[] {
    const parts = [0];
    const splits = this.splitNodes.slice(0, this.#level(segments) - 1);
    splits.forEach((node, split) => {
      parts[this.labelOf(node)] = 2 * split + 1;
      parts.push(2 * split + 2);
    });
    return parts;
  }

  /** Return what the label of a face at the last level, `maxSegments`, becomes at another level. */
  labelAt(label: number, segments: number): number {
    const count = this.#level(segments);
    while (label >= count) label = this.labelOf(at(this.splitNodes, label - 1));
    return label;
  }

  /** Return the labels of all faces at a level. `labels` are those at the last level. */
  labelsAt(labels: Int32Array, segments: number): Int32Array {
    const merged = Int32Array.from({ length: this.maxSegments }, (_, label) => this.labelAt(label, segments));
    return labels.map((label) => at(merged, label));
  }

  /** Return a number of segments within 1..maxSegments. */
  #level(segments: number): number {
    if (!Number.isInteger(segments) || segments < 1 || segments > this.maxSegments)
      throw new RangeError(`The number of segments is a whole number from 1 to ${this.maxSegments}, not ${segments}.`);
    return segments;
  }
}

function at(values: ArrayLike<number>, i: number): number {
  const value = values[i];
  if (value === undefined) throw new RangeError(`There is no number ${i} among ${values.length}.`);
  return value;
}
