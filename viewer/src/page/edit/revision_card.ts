/** The card that replaces the slider of levels while edited parts are shown, and the way between the two. */

import { byId } from "../dom";
import { plural } from "../text";
import type { Editor } from "./editor";

export class RevisionCard {
  readonly #editor: Editor;

  constructor(editor: Editor, onLevels: () => void) {
    this.#editor = editor;
    byId("edit-levels").addEventListener("click", () => {
      onLevels();
      editor.showLevels();
      byId("level").focus();
    });
    byId("edit-back").addEventListener("click", () => void editor.showNewest());
  }

  update(): void {
    const { labels, parts, base, isStored } = this.#editor;
    const isShown = labels !== null;
    byId("edit-card").hidden = !isShown;
    byId("level-card").hidden = isShown;
    byId("edit-back").hidden = isShown || base === 0;
    byId("edit-number").textContent = String(parts.length);
    byId("edit-unit").textContent = parts.length === 1 ? "part" : "parts";
    byId("edit-state").textContent = isStored
      ? `Edited, and stored with the job: revision ${base}.`
      : base > 0
        ? `The first change makes these ${plural(parts.length, "part")} a new revision; the edited ones stay stored.`
        : "Not edited yet. Every change is stored with the job.";
  }
}
