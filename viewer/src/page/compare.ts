/** Two segmentations of the same faces: which parts correspond, and how much differs. */

import type { Cut, FaceTable, PartTree } from "../component/element";

/** One of the results: its tree, its faces in the order of its model, and the leaf of every face of the input. */
export interface Side {
  readonly tree: PartTree;
  readonly faces: FaceTable;
  /** (F) place of every face of the input in the model. */
  readonly place: Uint32Array;
  /** (F) leaf of every face of the input. */
  readonly leaf: Uint32Array;
}

export interface Comparison {
  /** The part of A that each part of B overlaps most. */
  readonly toA: ReadonlyMap<number, number>;
  /** The part of A that each part of B corresponds to: each of the two overlaps the other most. */
  readonly pairs: ReadonlyMap<number, number>;
  /** 1 - Rand index: the share of pairs of points that are in one part in one result only; 0..1. */
  readonly rand: number;
  /** Share of the area that lies outside of corresponding parts; 0..1. */
  readonly share: number;
}

/** Return a side from the labels of its finest level in the order of the input. */
export function sideOf(tree: PartTree, faces: FaceTable, labels: Int32Array): Side {
  const leafOfNode = new Map(faces.leafNodes.map((node, leaf) => [node, leaf]));
  const leafOfLabel = tree.parts(tree.cutAt(tree.maxSegments)).map((node) => leafOfNode.get(node) ?? 0);
  const next = Uint32Array.from(faces.leafStart);
  const leaf = Uint32Array.from(labels, (label) => leafOfLabel[label]!);
  return { tree, faces, leaf, place: leaf.map((one) => next[one]++) };
}

/** Compares two sides at any of their cuts. */
export class Overlap {
  readonly #a: Side;
  readonly #b: Side;
  readonly #areas = new Map<number, number>(); // by leaf of A and leaf of B
  readonly #columns: number;

  constructor(a: Side, b: Side) {
    this.#a = a;
    this.#b = b;
    this.#columns = b.faces.leafNodes.length;
    for (let face = 0; face < a.leaf.length; face++) {
      const key = a.leaf[face]! * this.#columns + b.leaf[face]!;
      this.#areas.set(key, (this.#areas.get(key) ?? 0) + a.faces.areas[a.place[face]!]!);
    }
  }

  compare(cutA: Cut, cutB: Cut): Comparison {
    const [partsA, partsB] = [partsOf(this.#a, cutA), partsOf(this.#b, cutB)];
    const table = new Map<number, Map<number, number>>(); // areas by part of A and part of B
    for (const [key, area] of this.#areas) {
      const row = getOr(table, partsA[Math.floor(key / this.#columns)]!, () => new Map<number, number>());
      const part = partsB[key % this.#columns]!;
      row.set(part, (row.get(part) ?? 0) + area);
    }
    return comparisonOf(table);
  }

  /** Return the faces of each side, as its model numbers them, whose parts do not correspond. */
  differing(cutA: Cut, cutB: Cut, { pairs }: Comparison): { a: Uint32Array; b: Uint32Array } {
    const [partsA, partsB] = [partsOf(this.#a, cutA), partsOf(this.#b, cutB)];
    const found: [number[], number[]] = [[], []];
    this.#a.leaf.forEach((leafA, face) => {
      if (pairs.get(partsB[this.#b.leaf[face]!]!) === partsA[leafA]) return;
      found[0].push(this.#a.place[face]!);
      found[1].push(this.#b.place[face]!);
    });
    return { a: Uint32Array.from(found[0]), b: Uint32Array.from(found[1]) };
  }
}

/** Return the part of every leaf. */
function partsOf({ tree, faces }: Side, cut: Cut): number[] {
  return faces.leafNodes.map((node) => tree.partOf(cut, node));
}

function comparisonOf(table: ReadonlyMap<number, ReadonlyMap<number, number>>): Comparison {
  const areaB = new Map<number, number>();
  const best = new Map<number, [part: number, area: number]>(); // of each part of B
  const toB = new Map<number, number>();
  let [total, squares, both] = [0, 0, 0];
  for (const [a, row] of table) {
    const area = sum(row.values());
    total += area;
    squares += area ** 2;
    toB.set(a, [...row].reduce((most, entry) => (entry[1] > most[1] ? entry : most))[0]);
    for (const [b, shared] of row) {
      both += shared ** 2;
      areaB.set(b, (areaB.get(b) ?? 0) + shared);
      if (shared > (best.get(b)?.[1] ?? -1)) best.set(b, [a, shared]);
    }
  }
  squares += sum([...areaB.values()].map((area) => area ** 2));
  const mutual = [...best].filter(([b, [a]]) => toB.get(a) === b);
  const agreed = sum(mutual.map(([, [, area]]) => area));
  return {
    toA: new Map([...best].map(([b, [a]]) => [b, a])),
    pairs: new Map(mutual.map(([b, [a]]) => [b, a])),
    rand: total === 0 ? 0 : Math.max(squares - 2 * both, 0) / total ** 2,
    share: total === 0 ? 0 : Math.max(1 - agreed / total, 0),
  };
}

function sum(values: Iterable<number>): number {
  let total = 0;
  for (const value of values) total += value;
  return total;
}

function getOr<K, V>(map: Map<K, V>, key: K, make: () => V): V {
  const found = map.get(key);
  if (found !== undefined) return found;
  const made = make();
  map.set(key, made);
  return made;
}
