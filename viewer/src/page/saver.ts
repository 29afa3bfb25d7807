/** Saves the state of the shown job in the address and in the browser, some time after the last change. */

import { writeAddress } from "./address";
import { keepState } from "./kept";
import type { JobState } from "./state";

const PAUSE_MS = 250; // browsers limit how often a page may change its URL

export interface Shown {
  readonly job: string;
  readonly state: JobState;
}

export class Saver {
  readonly #shown: () => Shown | null;
  #waiting = 0;

  /** ``shown`` returns null while no job is shown. */
  constructor(shown: () => Shown | null) {
    this.#shown = shown;
  }

  later(): void {
    this.stop();
    this.#waiting = setTimeout(() => this.#save(), PAUSE_MS);
  }

  /** Drop changes that are not saved yet. */
  stop(): void {
    clearTimeout(this.#waiting);
  }

  #save(): void {
    const shown = this.#shown();
    if (shown === null) return;
    keepState(shown.job, shown.state);
    const address = writeAddress(shown.job, shown.state);
    if (address !== location.hash) history.replaceState(null, "", address);
  }
}
