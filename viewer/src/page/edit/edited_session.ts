/** The state of a job whose parts were edited by hand: its parts are those of a revision, and changes become revisions. */

import type { PartTree } from "../../component/element";
import { announce } from "../dom";
import { Session, type Modes } from "../session";
import type { Editor, Parts } from "./editor";
import type { Operation, Part } from "./revisions";

export class EditedSession extends Session {
  /** The session of the automatic result. */
  readonly levels: Session;
  /** (F) the part of each face of the file. */
  readonly labels: Int32Array;
  readonly details: readonly Part[];
  readonly #editor: Editor;

  /** ``tree`` has one step, whose leaves are the parts in the order of ``shown``. */
  constructor(
    editor: Editor,
    tree: PartTree,
    levels: Session,
    shown: Parts,
    modes: Modes,
    hidden: readonly number[],
    onChange: (news?: string) => void,
  ) {
    const { limitReached, firstModes } = levels;
    const { labels, parts: details } = shown;
    super(tree, { maxSegments: details.length, automaticSegments: details.length, limitReached, faces: 0 }, firstModes.up, onChange);
    this.#editor = editor;
    this.levels = levels;
    this.labels = labels;
    this.details = details;
    const names = new Map(this.parts.flatMap((id, part) => (details[part]!.name === "" ? [] : [[id, details[part]!.name] as const])));
    this.begin({ hidden: new Set(hidden), names }, modes);
  }

  override get query(): string {
    return this.#editor.query;
  }

  override get canUndo(): boolean {
    return this.#editor.canUndo;
  }

  override get canRedo(): boolean {
    return this.#editor.canRedo;
  }

  override undo(): void {
    void this.#editor.undo();
  }

  override redo(): void {
    void this.#editor.redo();
  }

  override rename(ids: readonly number[], name: string): void {
    const text = name.trim();
    const operations = ids.flatMap((id): Operation[] => {
      const part = this.numberOf(id);
      if (part === null) return [];
      return [text === "" || text === this.usualName(id) ? { op: "delete_name", part } : { op: "name", part, name: text }];
    });
    const isNone = operations.every(({ op }) => op === "delete_name");
    if (operations.length > 0) void this.#editor.edit(operations, isNone ? "Name deleted" : `Named ${text}`);
  }

  override mergeBelow(): void {
    this.#refuse();
  }

  override split(): void {
    announce("Edited parts have no cuts of their own: cut them along a line.");
  }

  override slide(): void {
    this.#refuse();
  }

  override showLevel(): void {
    this.#refuse();
  }

  #refuse(): void {
    announce("The parts were edited: start again from a level to change their number.");
  }
}
