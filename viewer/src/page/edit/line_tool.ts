/** What tools have in common that draw a line on the model. */

import type { Point } from "../../component/element";
import { announce } from "../dom";
import { facesOf, type Desk, type Tool } from "./tool";

const HALF_WIDTH = 2.5; // CSS pixels around the line whose faces belong to it

export abstract class LineTool implements Tool {
  abstract readonly id: string;
  abstract readonly hint: string;
  abstract readonly options: readonly HTMLElement[];
  readonly draws = "strokes";
  readonly radius = 0;
  readonly beginsAnywhere = true;
  protected readonly desk: Desk;
  #path: Point[] = [];

  constructor(desk: Desk) {
    this.desk = desk;
  }

  update(): void {}

  begin(point: Point): void {
    this.#path = [point];
  }

  move(points: readonly Point[]): void {
    this.#path.push(...points);
    this.desk.overlay.stroke(this.#path);
  }

  finish(): void {
    const path = this.#path;
    this.drop();
    const faces = facesOf(this.desk).alongPath(path, HALF_WIDTH);
    if (faces.length < 2) announce("Draw the line on the model.");
    else this.drawn(faces, path);
  }

  drop(): boolean {
    const wasDrawing = this.#path.length > 0;
    this.#path = [];
    this.desk.overlay.stroke([]);
    return wasDrawing;
  }

  /** Handle the faces under a finished line. */
  protected abstract drawn(faces: readonly number[], path: readonly Point[]): void;
}
