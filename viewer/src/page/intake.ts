/** Takes files from the file dialogs and from drops on the page. */

import { byId } from "./dom";
import { filesOf, filesOfDrop, TooManyFiles, type Found } from "./files";
import { COMPANIONS, MESHES } from "./sets";

export interface IntakeEvents {
  onFiles(found: readonly Found[]): void;
  onTooMany(): void;
}

export class Intake {
  readonly #events: IntakeEvents;
  readonly #input = byId<HTMLInputElement>("file");
  readonly #folder = byId<HTMLInputElement>("folder");

  constructor(events: IntakeEvents) {
    this.#events = events;
    this.#input.accept = [...MESHES, ".gz", ...COMPANIONS].join(",");
    for (const input of [this.#input, this.#folder])
      input.addEventListener("change", () => {
        void this.#take(() => Promise.resolve(filesOf(input))).finally(() => (input.value = ""));
      });
    for (const button of document.querySelectorAll(".choose")) button.addEventListener("click", () => this.choose());
    byId("choose-folder").addEventListener("click", () => this.#folder.click());
    byId("choose-folder").hidden = !("webkitdirectory" in this.#folder);
    this.#listenToDrops();
  }

  choose(): void {
    this.#input.click();
  }

  async #take(read: () => Promise<Found[]>): Promise<void> {
    try {
      this.#events.onFiles(await read());
    } catch (error) {
      if (!(error instanceof TooManyFiles)) throw error;
      this.#events.onTooMany();
    }
  }

  #listenToDrops(): void {
    let depth = 0;
    const mark = (by: number) => {
      depth = Math.max(depth + by, 0);
      document.body.classList.toggle("is-dropping", depth > 0);
    };
    addEventListener("dragenter", () => mark(1));
    addEventListener("dragleave", () => mark(-1));
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      mark(-depth);
      const { dataTransfer } = event;
      if (dataTransfer?.types.includes("Files")) void this.#take(() => filesOfDrop(dataTransfer));
    });
  }
}
