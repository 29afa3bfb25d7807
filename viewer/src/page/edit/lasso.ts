/** Moves the visible faces in a drawn outline to a part. */

import type { Point } from "../../component/element";
import { announce, h } from "../dom";
import { runsOf } from "./face_runs";
import { moved, movable, TargetChoice } from "./target";
import { facesOf, type Desk, type Tool } from "./tool";

export class Lasso implements Tool {
  readonly id = "lasso";
  readonly hint = "Draw around the faces that move to a part. The right button or two fingers turn the model.";
  readonly draws = "strokes";
  readonly radius = 0;
  readonly beginsAnywhere = true;
  readonly #desk: Desk;
  readonly #target: TargetChoice;
  readonly options: readonly HTMLElement[];
  #path: Point[] = [];

  constructor(desk: Desk) {
    this.#desk = desk;
    this.#target = new TargetChoice(desk, false);
    this.options = [h("label", {}, "To ", this.#target.element)];
  }

  update(): void {
    this.#target.update();
  }

  begin(point: Point): void {
    this.#path = [point];
  }

  move(points: readonly Point[]): void {
    this.#path.push(...points);
    this.#desk.overlay.stroke(this.#path, true);
  }

  finish(): void {
    const { editor, overlay } = this.#desk;
    const target = this.#target.value as number | "new";
    const faces = movable(this.#desk, facesOf(this.#desk).inOutline(this.#path), target === "new" ? -1 : target);
    this.#path = [];
    overlay.stroke([]);
    if (faces.length === 0) return announce("There are no faces to move in this outline.");
    void editor.edit([{ op: "assign", faces: runsOf(faces), to: target }], moved(faces.length));
  }

  drop(): boolean {
    const wasDrawing = this.#path.length > 0;
    this.#path = [];
    this.#desk.overlay.stroke([]);
    return wasDrawing;
  }
}
