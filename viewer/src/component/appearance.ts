/** A texture with three texels per leaf (colour, offset, part), rewritten when the cut or the selection changes. */

import { DataTexture, FloatType, NearestFilter, RGBAFormat } from "three";
import type { Colors } from "./cleave-viewer";
import type { PartitionedModel } from "./partition";
import type { Cut } from "./tree";

export interface Look {
  readonly cut: Cut;
  readonly hidden: ReadonlySet<number>;
  readonly selected: readonly number[];
  readonly hovered: number;
  /** sRGB colours in 0..1 of nodes that have others than those of their labels. */
  readonly colors: Colors;
  /** Whether parts are grey while others are selected. */
  readonly isDimmed: boolean;
  /** 0..1 */
  readonly explode: number;
}

const COLUMNS = 1024;
const ROWS = 3;
const FARTHEST = 0.85; // of the distance between the centres of a node and its child
const FIRST_SPLIT_ENDS = 0.45; // value of ``explode`` at which the coarsest cut is fully open; finer cuts open later

export class Appearance {
  readonly texture: DataTexture;
  readonly columns: number;
  /** (L) part of every leaf. */
  readonly partOfLeaf: Int32Array;
  readonly #values: Float32Array;
  readonly #model: PartitionedModel;
  readonly #centres: readonly (readonly [number, number, number])[];

  constructor(model: PartitionedModel) {
    const leaves = model.leafNodes.length;
    this.#model = model;
    this.columns = Math.min(leaves, COLUMNS);
    const rows = ROWS * Math.ceil(leaves / this.columns);
    this.#values = new Float32Array(4 * this.columns * rows);
    this.texture = new DataTexture(this.#values, this.columns, rows, RGBAFormat, FloatType);
    this.texture.minFilter = this.texture.magFilter = NearestFilter;
    this.partOfLeaf = new Int32Array(leaves);
    this.#centres = nodeCentres(model);
  }

  show(look: Look): void {
    const { tree, leafNodes, palette } = this.#model;
    const selected = new Set(look.selected);
    const offsets = this.#offsets(look);
    const parts = new Map<number, number>();
    leafNodes.forEach((node, leaf) => {
      let part = parts.get(node);
      if (part === undefined) parts.set(node, (part = tree.partOf(look.cut, node)));
      this.partOfLeaf[leaf] = part;
      const color = look.colors.get(part) ?? palette[tree.node(part).label % palette.length] ?? [0.6, 0.6, 0.6];
      const emphasis = part === look.hovered ? 1 : look.isDimmed && selected.size > 0 && !selected.has(part) ? -1 : 0;
      this.#write(leaf, 0, [...color, look.hidden.has(part) ? 0 : 1]);
      this.#write(leaf, 1, [...(offsets.get(part) ?? [0, 0, 0]), emphasis]);
      this.#write(leaf, 2, [part, selected.has(part) ? 1 : 0, 0, 0]);
    });
    this.texture.needsUpdate = true;
  }

  /** Show all leaves at their places. */
  showAll(): void {
    this.show({ cut: new Set(), hidden: new Set(), selected: [], hovered: -1, colors: new Map(), isDimmed: false, explode: 0 });
  }

  /** Return the offset of a leaf and whether it is hidden, as they were shown last. */
  stateOf(leaf: number): { offset: readonly [number, number, number]; isHidden: boolean } {
    const [, , , opacity] = this.#read(leaf, 0);
    const [x, y, z] = this.#read(leaf, 1);
    return { offset: [x!, y!, z!], isHidden: opacity! < 0.5 };
  }

  dispose(): void {
    this.texture.dispose();
  }

  #write(leaf: number, row: number, values: readonly number[]): void {
    this.#values.set(values, this.#place(leaf, row));
  }

  #read(leaf: number, row: number): Float32Array {
    const place = this.#place(leaf, row);
    return this.#values.subarray(place, place + 4);
  }

  #place(leaf: number, row: number): number {
    const line = ROWS * Math.floor(leaf / this.columns) + row;
    return 4 * (line * this.columns + (leaf % this.columns));
  }

  /** Return the offset of every part: the splits of each step move their sides apart, coarse steps first. */
  #offsets(look: Look): Map<number, number[]> {
    const { tree } = this.#model;
    const offsets = new Map<number, number[]>([[0, [0, 0, 0]]]);
    if (look.explode === 0) return offsets;
    const steps = tree.splitsOf(look.cut).map((split) => tree.node(tree.splitNode(split)).step);
    const order = new Map([...new Set(steps)].map((step, rank) => [step, rank]));
    tree.walk(look.cut, (id, isPart) => {
      if (isPart) return;
      const begins = ((order.get(tree.node(id).step) ?? 0) / Math.max(order.size, 1)) * (1 - FIRST_SPLIT_ENDS);
      const open = smooth((look.explode - begins) / FIRST_SPLIT_ENDS);
      for (const child of tree.node(id).children) {
        const own = offsets.get(id)!;
        offsets.set(
          child,
          own.map((value, k) => value + FARTHEST * open * (this.#centres[child]![k]! - this.#centres[id]![k]!)),
        );
      }
    });
    return offsets;
  }
}

function smooth(t: number): number {
  const x = Math.min(Math.max(t, 0), 1);
  return x * x * (3 - 2 * x);
}

/** Return the area-weighted centre of every node of the tree. */
function nodeCentres(model: PartitionedModel): [number, number, number][] {
  const { tree, leafNodes, leafArea, leafCentre } = model;
  const sums = tree.nodes.map(() => [0, 0, 0, 0] as [number, number, number, number]);
  leafNodes.forEach((node, leaf) => {
    const weight = leafArea[leaf]! + Number.MIN_VALUE;
    const [x, y, z] = leafCentre.subarray(3 * leaf, 3 * leaf + 3) as unknown as [number, number, number];
    for (let id = node; id >= 0; id = tree.node(id).parent) {
      const sum = sums[id]!;
      sum[0] += weight * x;
      sum[1] += weight * y;
      sum[2] += weight * z;
      sum[3] += weight;
    }
  });
  return sums.map(([x, y, z, w]) => (w > 0 ? [x / w, y / w, z / w] : [0, 0, 0]));
}
