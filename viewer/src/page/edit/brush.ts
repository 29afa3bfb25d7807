/** Moves the faces under a disc to a part. */

import type { Point } from "../../component/element";
import { h } from "../dom";
import { runsOf } from "./face_runs";
import { moved, movable, TargetChoice } from "./target";
import { facesOf, type Desk, type Tool } from "./tool";

const FIRST_RADIUS = 18; // CSS pixels
const NEW_COLOR = "#f5c400"; // until the server has chosen one

export class Brush implements Tool {
  readonly id = "brush";
  readonly hint = "Drag over faces to move them to a part.";
  readonly draws = "strokes";
  readonly beginsAnywhere = false;
  readonly #desk: Desk;
  readonly #target: TargetChoice;
  readonly #size = h("input", { type: "range", min: "3", max: "80", value: String(FIRST_RADIUS), "aria-label": "Size of the brush" });
  readonly options: readonly HTMLElement[];
  /** The faces of the present stroke; null if there is none. */
  #stroke: Set<number> | null = null;
  #reach: (path: readonly Point[]) => number[] = () => [];
  #part = 0;
  #isNew = false;
  #last: Point = [0, 0];

  constructor(desk: Desk) {
    this.#desk = desk;
    this.#target = new TargetChoice(desk, true);
    this.options = [h("label", {}, "To ", this.#target.element), h("label", {}, "Size ", this.#size)];
  }

  get radius(): number {
    return this.#size.valueAsNumber;
  }

  update(): void {
    this.#target.update();
    if (this.#stroke !== null) this.#paint([...this.#stroke]);
  }

  begin(point: Point): void {
    const { editor } = this.#desk;
    const target = this.#target.value;
    this.#isNew = target === "new";
    if (target === "start") {
      const face = facesOf(this.#desk).at(point);
      if (face < 0) return;
      this.#part = editor.labels![face]!;
    } else {
      this.#part = target === "new" ? editor.parts.length : target;
    }
    this.#stroke = new Set();
    this.#reach = facesOf(this.#desk).stroke(this.radius);
    this.#prepare();
    this.#last = point;
    this.move([point]);
  }

  move(points: readonly Point[]): void {
    if (this.#stroke === null) return;
    const path = [this.#last, ...points];
    this.#last = points.at(-1)!;
    const added = movable(this.#desk, this.#reach(path), this.#part);
    for (const face of added) this.#stroke.add(face);
    this.#paint(added);
  }

  finish(): void {
    const faces = this.#stroke;
    this.#stroke = null;
    if (faces === null) return;
    if (faces.size === 0) return this.#desk.editor.drop();
    const { editor } = this.#desk;
    const [first] = faces;
    const isNew = this.#isNew;
    const to = isNew ? "new" : this.#part;
    void editor.edit([{ op: "assign", faces: runsOf(faces), to }], moved(faces.size)).then((isStored) => {
      if (isStored && isNew) this.#target.value = editor.labels![first!]!;
    });
  }

  drop(): boolean {
    if (this.#stroke === null) return false;
    this.#stroke = null;
    this.#desk.editor.drop();
    return true;
  }

  /** Give a new part a colour before the first face is painted. */
  #prepare(): void {
    const { editor } = this.#desk;
    if (!this.#isNew) return;
    const part = { name: "", color: NEW_COLOR, class: "", locked: false, faces: 0 };
    editor.show({ labels: editor.labels!, parts: [...editor.parts, part] }, this.#part);
  }

  #paint(faces: readonly number[]): void {
    if (faces.length > 0) this.#desk.viewer.paint(faces, this.#part);
  }
}
