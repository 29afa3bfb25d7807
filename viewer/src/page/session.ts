/** The editing state of a result (level, cuts by hand, hidden parts, names) with undo, and its display modes. */

import type { Cut, LoadDetail, Look, PartTree } from "../component/element";
import type { Axis, Job } from "./api";
import { carryHidden, cutWith, editsOf, NO_EDITS, type Edits } from "./edits";
import { History } from "./history";
import lists from "./lists.json";
import { plural } from "./text";

/** The state that undo restores. */
export interface Work {
  /** The number of parts before the edits. */
  readonly level: number;
  readonly edits: Edits;
  /** Of the level with the edits. */
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

/** A job and how it is shown. */
export interface Result {
  readonly job: Job;
  readonly session: Session;
}

export class Session {
  readonly tree: PartTree;
  readonly automaticSegments: number;
  /** Whether the hierarchy ends at a limit although sensible cuts are left; null if that is not known. */
  readonly limitReached: boolean | null;
  readonly firstModes: Modes;
  readonly #onChange: (news?: string) => void;
  #work: Work;
  #modes: Modes;
  readonly #history = new History<Work>();
  #slidingFrom: Work | null = null;
  /** For the parts of a cut that are equal to others, all of these. */
  #copies: { readonly cut: Cut; readonly byNode: ReadonlyMap<number, readonly number[]> } | null = null;
  #numbers: { cut: Cut; byNode: ReadonlyMap<number, number> } | null = null;

  /** ``onChange`` is called after each change, with a sentence for screen readers if the control itself says nothing. */
  constructor(tree: PartTree, { automaticSegments, limitReached }: LoadDetail, up: Axis, onChange: (news?: string) => void) {
    this.tree = tree;
    this.automaticSegments = automaticSegments;
    this.limitReached = limitReached;
    this.firstModes = this.#modes = { ...FIRST_MODES, up };
    this.#onChange = onChange;
    const cut = tree.cutAt(automaticSegments);
    this.#work = { level: automaticSegments, edits: NO_EDITS, cut, hidden: new Set(), names: new Map() };
  }

  get work(): Work {
    return this.#work;
  }

  get modes(): Modes {
    return this.#modes;
  }

  /** The parts in the order of their numbers. */
  get parts(): number[] {
    return [...this.#numbersOfParts().keys()];
  }

  get isEdited(): boolean {
    const { split, merged } = this.#work.edits;
    return split.size + merged.size > 0;
  }

  get canUndo(): boolean {
    return this.#history.canUndo;
  }

  get canRedo(): boolean {
    return this.#history.canRedo;
  }

  /** Return the number of a part, which is its label in the files of this cut; null for a group. */
  numberOf(id: number): number | null {
    return this.#numbersOfParts().get(id) ?? null;
  }

  /** Return the numbers of parts; groups are left out. */
  numbersOf(ids: readonly number[]): number[] {
    return ids.map((id) => this.numberOf(id)).filter((part) => part !== null);
  }

  /** Keep which parts of the present cut are equal, as groups of their numbers. */
  showCopies(groups: readonly (readonly number[])[]): void {
    const { parts } = this;
    const groupsOfNodes = groups.map((numbers) => numbers.map((number) => parts[number]!));
    const byNode = new Map(groupsOfNodes.flatMap((ids) => ids.map((id) => [id, ids] as const)));
    this.#copies = { cut: this.#work.cut, byNode };
    this.#onChange();
  }

  /** Return the parts that are equal to a part, with itself; none if there are none or they are not known. */
  copiesOf(id: number): readonly number[] {
    return this.knowsCopies ? (this.#copies!.byNode.get(id) ?? []) : [];
  }

  /** Whether showCopies() was called for the present cut. */
  get knowsCopies(): boolean {
    return this.#copies?.cut === this.#work.cut;
  }

  /** Return the name of a node: the given one, or that of the files. */
  nameOf(id: number): string {
    return this.#work.names.get(id) ?? this.usualName(id);
  }

  /** Return the name of a node in the files if none is given. */
  usualName(id: number): string {
    const number = this.numberOf(id);
    return number === null ? "Group" : `${lists.segmentName} ${number}`;
  }

  /** The query string that selects the present cut in the API. */
  get query(): string {
    const level = this.tree.levelOf(this.#work.cut);
    return level === null ? `?splits=${this.tree.splitsOf(this.#work.cut).join(",")}` : `?segments=${level}`;
  }

  /** Set the first state without a notice. */
  protected begin(work: Partial<Work>, modes: Modes): void {
    this.#work = { ...this.#work, ...work };
    this.#modes = modes;
  }

  /** Replace the state by that of a link. */
  restore(work: Partial<Pick<Work, "level" | "edits" | "hidden" | "names">>, modes: Partial<Modes>): void {
    const { level, edits, hidden, names } = { ...this.#work, ...work };
    const cut = cutWith(this.tree, level, edits);
    this.#work = { level, edits, cut, names, hidden: carryHidden(this.tree, cut, cut, hidden) };
    this.#modes = { ...this.#modes, ...modes };
    this.#modes = { ...this.#modes, selected: this.#carrySelected() };
    this.#onChange();
  }

  setModes(modes: Partial<Modes>): void {
    this.#modes = { ...this.#modes, ...modes };
    this.#onChange();
  }

  /** Show a level while the slider moves; all steps until endSlide are one undo step. */
  slide(level: number): void {
    this.#slidingFrom ??= this.#work;
    this.#level(level);
    this.#onChange();
  }

  endSlide(): void {
    if (this.#slidingFrom !== null && this.#slidingFrom.cut !== this.#work.cut) this.#history.remember(this.#slidingFrom);
    this.#slidingFrom = null;
    this.#onChange();
  }

  showLevel(level: number): void {
    this.#change(() => this.#level(level), () => `${this.#count()}.`);
  }

  /** Show the next level at which a step is complete, or the one before. */
  showStep(by: 1 | -1): void {
    this.showLevel(this.tree.stepEndBeside(this.#work.level, by));
  }

  split(ids: readonly number[]): void {
    const names = ids.map((id) => this.nameOf(id)).join(", ");
    const cut = ids.reduce((cut, id) => this.tree.split(cut, id), this.#work.cut);
    if (cut.size > this.#work.cut.size) this.#change(() => this.#edit(cut), () => `${names} split: ${this.#count()}.`);
  }

  /** Merge all parts below a node into one. */
  mergeBelow(id: number): void {
    const merged = this.tree.partsBelow(this.#work.cut, id).length;
    this.#change(
      () => {
        this.#edit(this.tree.merge(this.#work.cut, id));
        this.#modes = { ...this.#modes, selected: [id] };
      },
      () => `${plural(merged, "part")} merged into ${this.nameOf(id)}: ${this.#count()}.`,
    );
  }

  /** Return the node whose parts are exactly these; null if there is none, so that no cut of the tree merges them. */
  groupOf(ids: readonly number[]): number | null {
    if (ids.length < 2) return null;
    const above = this.tree.commonAncestor(ids);
    return this.tree.partsBelow(this.#work.cut, above).length === ids.length ? above : null;
  }

  /** Undo all cuts by hand at once. */
  discardEdits(): void {
    this.#change(
      () => this.#recut(this.tree.cutAt(this.#work.level), NO_EDITS),
      () => `Cuts by hand discarded: ${this.#count()}.`,
    );
  }

  setHidden(ids: readonly number[], isHidden: boolean): void {
    const hidden = new Set(this.#work.hidden);
    for (const id of ids) {
      if (isHidden) hidden.add(id);
      else hidden.delete(id);
    }
    this.#hide(hidden);
  }

  isolate(ids: readonly number[]): void {
    this.#hide(new Set(this.parts.filter((part) => !ids.includes(part))));
  }

  showAll(): void {
    if (this.#work.hidden.size > 0) this.#hide(new Set());
  }

  /** Give some parts one name; without one they get their usual names back. */
  rename(ids: readonly number[], name: string): void {
    const names = new Map(this.#work.names);
    for (const id of ids) {
      if (name.trim() === "" || name.trim() === this.usualName(id)) names.delete(id);
      else names.set(id, name.trim());
    }
    this.#change(() => (this.#work = { ...this.#work, names }));
  }

  undo(): void {
    this.#return(this.#history.undo(this.#work), "Undone");
  }

  redo(): void {
    this.#return(this.#history.redo(this.#work), "Redone");
  }

  #return(work: Work | null, done: string): void {
    if (work === null) return;
    this.#work = work;
    this.#modes = { ...this.#modes, selected: this.#carrySelected() };
    this.#onChange(`${done}: ${this.#count()}.`);
  }

  #change(make: () => void, news?: () => string): void {
    const before = this.#work;
    make();
    if (this.#work !== before) this.#history.remember(before);
    this.#onChange(news?.());
  }

  #hide(hidden: ReadonlySet<number>): void {
    const left = this.parts.length - hidden.size;
    this.#change(() => (this.#work = { ...this.#work, hidden }), () => `${plural(left, "part")} of ${this.parts.length} shown.`);
  }

  #level(level: number): void {
    this.#work = { ...this.#work, level };
    this.#recut(cutWith(this.tree, level, this.#work.edits), this.#work.edits);
  }

  #edit(cut: Cut): void {
    this.#recut(cut, editsOf(this.tree, this.#work.level, cut, this.#work.edits));
  }

  #recut(cut: Cut, edits: Edits): void {
    const { cut: before, hidden } = this.#work;
    this.#work = { ...this.#work, cut, edits, hidden: carryHidden(this.tree, before, cut, hidden) };
    this.#modes = { ...this.#modes, selected: this.#carrySelected() };
  }

  #count(): string {
    return plural(this.parts.length, "part");
  }

  #numbersOfParts(): ReadonlyMap<number, number> {
    const { cut } = this.#work;
    if (this.#numbers?.cut !== cut)
      this.#numbers = { cut, byNode: new Map(this.tree.parts(cut).map((id, number) => [id, number])) };
    return this.#numbers.byNode;
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
