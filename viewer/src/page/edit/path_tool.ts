/** What tools have in common that draw a path on the model. */

import type { Point } from "../../component/element";
import type { Desk, Tool } from "./tool";

export abstract class PathTool implements Tool {
  abstract readonly id: string;
  abstract readonly hint: string;
  abstract readonly options: readonly HTMLElement[];
  readonly draws = "strokes";
  readonly radius = 0;
  readonly beginsAnywhere = true;
  /** Whether the path is an outline. */
  protected readonly isClosed: boolean = false;
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
    this.desk.overlay.stroke(this.#path, this.isClosed);
  }

  finish(): void {
    const path = this.#path;
    this.drop();
    this.finished(path);
  }

  drop(): boolean {
    const wasDrawing = this.#path.length > 0;
    this.#path = [];
    this.desk.overlay.stroke([]);
    return wasDrawing;
  }

  /** Handle a finished path. */
  protected abstract finished(path: readonly Point[]): void;
}
