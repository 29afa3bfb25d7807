/** The steps of undo and redo. */

const MOST_STEPS = 200;

export class History<T> {
  #past: T[] = [];
  #future: T[] = [];

  get canUndo(): boolean {
    return this.#past.length > 0;
  }

  get canRedo(): boolean {
    return this.#future.length > 0;
  }

  /** Add the state before a change. */
  remember(before: T): void {
    this.#past = [...this.#past, before].slice(-MOST_STEPS);
    this.#future = [];
  }

  /** Return the state before the present one; null if there is none. */
  undo(present: T): T | null {
    return move(this.#past, this.#future, present);
  }

  /** Return the state after the present one; null if there is none. */
  redo(present: T): T | null {
    return move(this.#future, this.#past, present);
  }
}

function move<T>(from: T[], to: T[], present: T): T | null {
  const next = from.pop();
  if (next === undefined) return null;
  to.push(present);
  return next;
}
