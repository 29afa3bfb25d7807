/** The order of revisions for undo and redo, which restore earlier ones as new revisions. */

export class Undo {
  /** Revisions with different parts, oldest first. */
  readonly #revisions: number[];
  #at: number;

  constructor(newest: number) {
    this.#revisions = Array.from({ length: newest + 1 }, (_, number) => number);
    this.#at = newest;
  }

  /** The revision that undo restores; null if there is none. */
  get before(): number | null {
    return this.#revisions[this.#at - 1] ?? null;
  }

  /** The revision that redo restores; null if there is none. */
  get after(): number | null {
    return this.#revisions[this.#at + 1] ?? null;
  }

  /** Note a revision that an edit has made: what was undone cannot be redone. */
  add(revision: number): void {
    this.#revisions.splice(++this.#at, Infinity, revision);
  }

  move(by: 1 | -1): void {
    this.#at += by;
  }
}
