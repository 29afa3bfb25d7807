/** Draws the border between two parts anew: along a line, as the least cut, or without jags. */

import type { Point } from "../../component/element";
import { announce, h } from "../dom";
import { runsOf } from "./face_runs";
import { LineTool } from "./line_tool";
import { facesOf, partsUnder, selectedParts, type Desk } from "./tool";

const REACH = 32; // CSS pixels around a line in which its two parts are looked for

export class BorderTool extends LineTool {
  readonly id = "border";
  readonly hint = "Draw where the border between two parts is to be. The right button or two fingers turn the model.";
  readonly #least = h("button", { type: "button", title: "The least cut near the border of the two selected parts" }, "Least cut");
  readonly #smooth = h("button", { type: "button", title: "Make the borders of the selected parts, or all, short" }, "Smooth");
  readonly options = [this.#least, this.#smooth];

  constructor(desk: Desk) {
    super(desk);
    this.#least.addEventListener("click", () => this.#drawLeast());
    this.#smooth.addEventListener("click", () => {
      const parts = selectedParts(desk);
      void desk.editor.edit([{ op: "smooth", parts: parts.length > 0 ? parts : null }], "Borders are smooth");
    });
  }

  override update(): void {
    this.#least.disabled = selectedParts(this.desk).length !== 2;
  }

  protected drawn(faces: readonly number[], path: readonly Point[]): void {
    const selected = selectedParts(this.desk);
    const near = partsUnder(this.desk, facesOf(this.desk).alongPath(path, REACH));
    const [a, b] = selected.length === 2 ? selected : near;
    if (a === undefined || b === undefined) return announce("There are no two parts near this line.");
    void this.desk.editor.edit([{ op: "border", a, b, stroke: runsOf(faces) }], "The border is drawn anew");
  }

  #drawLeast(): void {
    const [a, b] = selectedParts(this.desk);
    if (a === undefined || b === undefined) return;
    void this.desk.editor.edit([{ op: "border", a, b, stroke: runsOf([]) }], "The border is the least cut");
  }
}
