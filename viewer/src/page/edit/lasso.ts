/** Moves the visible faces in a drawn outline to a part. */

import type { Point } from "../../component/element";
import { announce, h } from "../dom";
import { runsOf } from "./face_runs";
import { PathTool } from "./path_tool";
import { moved, movable, TargetChoice } from "./target";
import { facesOf, type Desk } from "./tool";

export class Lasso extends PathTool {
  readonly id = "lasso";
  readonly hint = "Draw around the faces that move to a part. The right button or two fingers turn the model.";
  readonly options: readonly HTMLElement[];
  protected override readonly isClosed = true;
  readonly #target: TargetChoice;

  constructor(desk: Desk) {
    super(desk);
    this.#target = new TargetChoice(desk, false);
    this.options = [h("label", {}, "To ", this.#target.element)];
  }

  override update(): void {
    this.#target.update();
  }

  protected finished(outline: readonly Point[]): void {
    const target = this.#target.value as number | "new";
    const faces = movable(this.desk, facesOf(this.desk).inOutline(outline), target === "new" ? -1 : target);
    if (faces.length === 0) return announce("There are no faces to move in this outline.");
    void this.desk.editor.edit([{ op: "assign", faces: runsOf(faces), to: target }], moved(faces.length));
  }
}
