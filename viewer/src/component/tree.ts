/** The tree of cuts, and its cuts: the parts at a level or after edits by hand. */

import type { Cut, Tree, TreeNode } from "./cleave-viewer";

export type { Cut, TreeNode };

export class PartTree implements Tree {
  readonly nodes: readonly TreeNode[];

  constructor(nodes: readonly TreeNode[]) {
    this.nodes = nodes;
  }

  node(id: number): TreeNode {
    const node = this.nodes[id];
    if (node === undefined) throw new RangeError(`The tree has no node ${id}.`);
    return node;
  }

  get maxSegments(): number {
    return (this.nodes.length + 1) / 2;
  }

  get totalArea(): number {
    return this.node(0).area;
  }

  /** Entry i: value of the cut from i + 1 to i + 2 segments. */
  get cutValues(): (number | null)[] {
    return Array.from({ length: this.maxSegments - 1 }, (_, split) => this.node(this.splitNode(split)).cutValue);
  }

  /** Return the node that a split cuts. */
  splitNode(split: number): number {
    return this.node(2 * split + 1).parent;
  }

  /** Return the split that cuts a node; -1 for a leaf. */
  splitOf(id: number): number {
    const first = this.node(id).children[0];
    return first === undefined ? -1 : (first - 1) / 2;
  }

  /** The numbers of segments that are worth offering: 1, and those after the last split of each step. */
  get stepEnds(): number[] {
    const last = new Map<number | null, number>();
    for (let split = 0; split < this.maxSegments - 1; split++) last.set(this.node(this.splitNode(split)).step, split + 2);
    return [1, ...[...last.values()].sort((a, b) => a - b)];
  }

  /** Return the number of segments at the next step end, or at the one before, clipped to those there are. */
  stepEndBeside(segments: number, by: 1 | -1): number {
    const ends = this.stepEnds;
    const end = by > 0 ? ends.find((end) => end > segments) : ends.findLast((end) => end < segments);
    return end ?? (by > 0 ? this.maxSegments : 1);
  }

  /** Whether the cut of a node belongs to the step of the cut above it: its parts are shown beside those of its parent. */
  isPassedOver(id: number): boolean {
    const { parent, step } = this.node(id);
    return parent >= 0 && step !== null && this.node(parent).step === step;
  }

  /** Return the node below which a node is shown; -1 for the whole mesh. */
  groupOf(id: number): number {
    let group = this.node(id).parent;
    while (group >= 0 && this.isPassedOver(group)) group = this.node(group).parent;
    return group;
  }

  /** Return the nodes that are shown below a node of a cut, sorted by label. */
  childrenIn(cut: Cut, id: number): number[] {
    const children: number[] = [];
    const waiting = [...this.node(id).children];
    for (let child = waiting.pop(); child !== undefined; child = waiting.pop())
      if (cut.has(child) && this.isPassedOver(child)) waiting.push(...this.node(child).children);
      else children.push(child);
    return children.sort((a, b) => this.node(a).label - this.node(b).label);
  }

  /** Return the cut with a number of segments, clipped to 1..maxSegments. */
  cutAt(segments: number): Cut {
    const count = Math.min(Math.max(Math.round(segments), 1), this.maxSegments) - 1;
    return new Set(Array.from({ length: count }, (_, split) => this.splitNode(split)));
  }

  /** Return the cut with the given splits and the splits above them. */
  cutOfSplits(splits: Iterable<number>): Cut {
    const cut = new Set<number>();
    for (const split of splits) {
      if (!Number.isInteger(split) || split < 0 || split >= this.maxSegments - 1) continue;
      for (let id = this.splitNode(split); id >= 0; id = this.node(id).parent) cut.add(id);
    }
    return cut;
  }

  /** Return the splits of a cut in ascending order. */
  splitsOf(cut: Cut): number[] {
    return [...cut].map((id) => this.splitOf(id)).sort((a, b) => a - b);
  }

  /** Return the number of segments of a cut; null if it is not a level of the tree. */
  levelOf(cut: Cut): number | null {
    for (let split = 0; split < cut.size; split++) if (!cut.has(this.splitNode(split))) return null;
    return cut.size + 1;
  }

  /** Return the parts of a cut, sorted by label. */
  parts(cut: Cut): number[] {
    const parts: number[] = [];
    this.walk(cut, (id, isPart) => isPart && parts.push(id));
    return parts.sort((a, b) => this.node(a).label - this.node(b).label);
  }

  /** Visit the nodes of a cut, parents first. */
  walk(cut: Cut, visit: (id: number, isPart: boolean) => void): void {
    const waiting = [0];
    for (let id = waiting.pop(); id !== undefined; id = waiting.pop()) {
      const { children } = this.node(id);
      const isPart = children.length === 0 || !cut.has(id);
      visit(id, isPart);
      if (!isPart) waiting.push(...children.toReversed());
    }
  }

  /** Visit the nodes of a cut that are shown: those of the n-ary tree, in which equal parts are siblings. */
  walkShown(cut: Cut, visit: (id: number, isPart: boolean, depth: number) => void): void {
    const waiting: [number, number][] = [[0, 0]];
    for (let entry = waiting.pop(); entry !== undefined; entry = waiting.pop()) {
      const [id, depth] = entry;
      const isPart = this.node(id).children.length === 0 || !cut.has(id);
      visit(id, isPart, depth);
      if (!isPart) for (const child of this.childrenIn(cut, id).toReversed()) waiting.push([child, depth + 1]);
    }
  }

  /** Return the part that contains a node; -1 if the node itself is split. */
  partOf(cut: Cut, id: number): number {
    if (cut.has(id)) return -1;
    let part = id;
    // A cut contains the parents of its nodes: all above the first one in it are in it, too.
    for (let above = this.node(id).parent; above >= 0 && !cut.has(above); above = this.node(above).parent) part = above;
    return part;
  }

  /** Whether ``above`` is ``below`` or one of its ancestors. */
  contains(above: number, below: number): boolean {
    for (let id = below; id >= above; id = this.node(id).parent) if (id === above) return true;
    return false;
  }

  /** Return the parts of a cut at or below a node. */
  partsBelow(cut: Cut, id: number): number[] {
    return this.parts(cut).filter((part) => this.contains(id, part));
  }

  /** Return the cut with one more part split, together with the parts below it that belong to the step. */
  split(cut: Cut, part: number): Cut {
    if (this.node(part).children.length === 0) return cut;
    const split = new Set(cut);
    const waiting = [part];
    for (let id = waiting.pop(); id !== undefined; id = waiting.pop()) {
      split.add(id);
      waiting.push(...this.node(id).children.filter((child) => this.isPassedOver(child)));
    }
    return split;
  }

  /** Return the cut with all parts below a node merged. */
  merge(cut: Cut, id: number): Cut {
    return new Set([...cut].filter((other) => !this.contains(id, other)));
  }

  /** Return the lowest node of the n-ary tree that contains all the given nodes; for a single node its parent. */
  commonAncestor(ids: readonly number[]): number {
    const [first, ...others] = ids;
    if (first === undefined) return 0;
    let above = others.length === 0 ? Math.max(this.groupOf(first), 0) : first;
    while (!others.every((id) => this.contains(above, id))) above = this.groupOf(above);
    return above;
  }
}
