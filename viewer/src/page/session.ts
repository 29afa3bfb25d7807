/** The editing state of a result (cut, hidden parts, names) with undo, and its display modes. */

import type { Axis } from "./api";
import type { Cut, LoadDetail, Look, PartTree } from "../component/element";

/** The state that undo restores. */
export interface Work {
  readonly cut: Cut;
  readonly hidden: ReadonlySet<number>;
  readonly names: ReadonlyMap<number, string>;
}

export interface Modes {
  readonly selected: readonly number[];
  readonly explode: number;
  readonly wireframe: boolean;
  readonly concavity: boolean;
  readonly lines: boolean;
  readonly up: Axis;
  readonly look: Look;
}

export const LOOKS: readonly Look[] = ["parts", "original", "both"];

const FIRST_MODES: Modes = {
  selected: [],
  explode: 0,
  wireframe: false,
  concavity: false,
  lines: true,
  up: "y",
  look: "parts",
};

const MOST_STEPS = 200;

export class Session {
  readonly tree: PartTree;
  readonly automaticSegments: number;
  /** Whether the hierarchy ends at a limit although sensible cuts are left; null if that is not known. */
  readonly limitReached: boolean | null;
  readonly firstModes: Modes;
  readonly #onChange: () => void;
  #work: Work;
  #modes: Modes;
  #past: Work[] = [];
  #future: Work[] = [];
  #slidingFrom: Work | null = null;

  constructor(tree: PartTree, { automaticSegments, limitReached }: LoadDetail, up: Axis, onChange: () => void) {
    this.tree = tree;
    this.automaticSegments = automaticSegments;
    this.limitReached = limitReached;
    this.firstModes = this.#modes = { ...FIRST_MODES, up };
    this.#onChange = onChange;
    this.#work = { cut: tree.cutAt(automaticSegments), hidden: new Set(), names: new Map() };
  }

  get work(): Work {
    return this.#work;
  }

  get modes(): Modes {
    return this.#modes;
  }

  get parts(): number[] {
    return this.tree.parts(this.#work.cut);
  }

  get canUndo(): boolean {
    return this.#past.length > 0;
  }

  get canRedo(): boolean {
    return this.#future.length > 0;
  }

  nameOf(id: number): string {
    const name = this.#work.names.get(id);
    if (name !== undefined) return name;
    const isPart = this.tree.partOf(this.#work.cut, id) === id;
    return isPart ? `Part ${this.tree.node(id).label + 1}` : "Group";
  }

  /** Replace the state by that of a link. */
  restore(work: Partial<Work>, modes: Partial<Modes>): void {
    this.#work = { ...this.#work, ...work };
    this.#work = { ...this.#work, hidden: carryHidden(this.tree, this.#work.cut, this.#work.cut, this.#work.hidden) };
    this.#modes = { ...this.#modes, ...modes };
    this.#modes = { ...this.#modes, selected: this.#carrySelected() };
    this.#onChange();
  }

  setModes(modes: Partial<Modes>): void {
    this.#modes = { ...this.#modes, ...modes };
    this.#onChange();
  }

  /** Show a level while the slider moves; all steps until endSlide are one undo step. */
  slide(segments: number): void {
    this.#slidingFrom ??= this.#work;
    this.#recut(this.tree.cutAt(segments));
    this.#onChange();
  }

  endSlide(): void {
    if (this.#slidingFrom !== null && this.#slidingFrom.cut !== this.#work.cut) this.#remember(this.#slidingFrom);
    this.#slidingFrom = null;
    this.#onChange();
  }

  showLevel(segments: number): void {
    this.#change(() => this.#recut(this.tree.cutAt(segments)));
  }

  /** Show the next level at which a step is complete, or the one before. */
  showStep(by: 1 | -1): void {
    this.showLevel(this.tree.stepEndBeside(this.parts.length, by));
  }

  split(ids: readonly number[]): void {
    const cut = ids.reduce((cut, id) => this.tree.split(cut, id), this.#work.cut);
    this.#change(() => this.#recut(cut));
  }

  /** Merge all parts below a node into one. */
  mergeBelow(id: number): void {
    this.#change(() => {
      this.#recut(this.tree.merge(this.#work.cut, id));
      this.#modes = { ...this.#modes, selected: [id] };
    });
  }

  setHidden(ids: readonly number[], isHidden: boolean): void {
    const hidden = new Set(this.#work.hidden);
    for (const id of ids) {
      if (isHidden) hidden.add(id);
      else hidden.delete(id);
    }
    this.#change(() => (this.#work = { ...this.#work, hidden }));
  }

  isolate(ids: readonly number[]): void {
    const hidden = new Set(this.parts.filter((part) => !ids.includes(part)));
    this.#change(() => (this.#work = { ...this.#work, hidden }));
  }

  showAll(): void {
    if (this.#work.hidden.size > 0) this.#change(() => (this.#work = { ...this.#work, hidden: new Set() }));
  }

  rename(id: number, name: string): void {
    const names = new Map(this.#work.names);
    if (name.trim() === "") names.delete(id);
    else names.set(id, name.trim());
    this.#change(() => (this.#work = { ...this.#work, names }));
  }

  undo(): void {
    this.#moveHistory(this.#past, this.#future);
  }

  redo(): void {
    this.#moveHistory(this.#future, this.#past);
  }

  #moveHistory(from: Work[], to: Work[]): void {
    const work = from.pop();
    if (work === undefined) return;
    to.push(this.#work);
    this.#work = work;
    this.#modes = { ...this.#modes, selected: this.#carrySelected() };
    this.#onChange();
  }

  #change(make: () => void): void {
    const before = this.#work;
    make();
    if (this.#work !== before) this.#remember(before);
    this.#onChange();
  }

  #remember(work: Work): void {
    this.#past = [...this.#past, work].slice(-MOST_STEPS);
    this.#future = [];
  }

  #recut(cut: Cut): void {
    const { cut: before, hidden } = this.#work;
    this.#work = { ...this.#work, cut, hidden: carryHidden(this.tree, before, cut, hidden) };
    this.#modes = { ...this.#modes, selected: this.#carrySelected() };
  }

  /** Return the selection, mapped to the parts of the present cut. */
  #carrySelected(): number[] {
    const { tree } = this;
    const parts = this.#modes.selected.flatMap((id) => {
      if (id >= tree.nodes.length) return [];
      const part = tree.partOf(this.#work.cut, id);
      return part >= 0 ? [part] : tree.partsBelow(this.#work.cut, id);
    });
    return [...new Set(parts)];
  }
}

/** Hide a part of the new cut if it, its ancestor or all its descendants were hidden in the old one. */
function carryHidden(tree: PartTree, before: Cut, after: Cut, hidden: ReadonlySet<number>): Set<number> {
  if (hidden.size === 0) return new Set();
  return new Set(
    tree.parts(after).filter((part) => {
      const above = tree.partOf(before, part);
      return above >= 0 ? hidden.has(above) : tree.partsBelow(before, part).every((id) => hidden.has(id));
    }),
  );
}
