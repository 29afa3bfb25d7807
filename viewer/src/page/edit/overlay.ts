/** The drawing above the model: strokes, marks, the disc of the brush and the crosshair of the keys. */

import type { CleaveViewer, Point } from "../../component/element";
import { byId } from "../dom";

const SVG = "http://www.w3.org/2000/svg";
const MARK = 7; // radius in CSS pixels

export interface Mark {
  readonly face: number;
  readonly isMinus: boolean;
}

export class Overlay {
  readonly #viewer: CleaveViewer;
  readonly #box = byId<SVGSVGElement>("edit-overlay");
  readonly #path = this.#add("path", "stroke");
  readonly #disc = this.#add("circle", "disc");
  readonly #cross = this.#add("path", "crosshair");
  readonly #marks = this.#add("g", "marks");
  #shown: readonly Mark[] = [];

  constructor(viewer: CleaveViewer) {
    this.#viewer = viewer;
    new ResizeObserver(() => this.#place()).observe(viewer);
    viewer.addEventListener("cleave-view", () => this.#placeMarks());
  }

  /** Show a line, closed to an outline if wanted; none without points. */
  stroke(points: readonly Point[], isClosed = false): void {
    const d = points.map(([x, y], i) => `${i === 0 ? "M" : "L"}${x} ${y}`).join("");
    this.#path.setAttribute("d", isClosed && points.length > 2 ? `${d}Z` : d);
    this.#path.classList.toggle("is-closed", isClosed);
  }

  /** Show a disc around a point; null hides it. */
  disc(point: Point | null, radius: number): void {
    this.#disc.setAttribute("r", point === null ? "0" : String(radius));
    if (point === null) return;
    this.#disc.setAttribute("cx", String(point[0]));
    this.#disc.setAttribute("cy", String(point[1]));
  }

  crosshair(point: Point | null): void {
    const [x, y] = point ?? [0, 0];
    this.#cross.setAttribute("d", point === null ? "" : `M${x - 12} ${y}h9m6 0h9M${x} ${y - 12}v9m0 6v9`);
  }

  marks(marks: readonly Mark[]): void {
    this.#shown = marks;
    this.#placeMarks();
  }

  clear(): void {
    this.stroke([]);
    this.disc(null, 0);
    this.crosshair(null);
    this.marks([]);
  }

  /** Move the marks to their faces. */
  #placeMarks(): void {
    const faces = this.#shown.length === 0 ? null : this.#viewer.sight;
    this.#marks.replaceChildren(
      ...this.#shown.flatMap(({ face, isMinus }) => {
        const place = faces?.place(face);
        if (place === null || place === undefined) return [];
        const [x, y] = place;
        const mark = document.createElementNS(SVG, "path");
        mark.setAttribute("class", isMinus ? "mark is-minus" : "mark");
        const circle = `M${x - MARK} ${y}a${MARK} ${MARK} 0 1 0 ${2 * MARK} 0a${MARK} ${MARK} 0 1 0 ${-2 * MARK} 0Z`;
        mark.setAttribute("d", `${circle}M${x - 3.5} ${y}h7${isMinus ? "" : `M${x} ${y - 3.5}v7`}`);
        return [mark];
      }),
    );
  }

  /** Cover the viewer. */
  #place(): void {
    const { offsetLeft, offsetTop, offsetWidth, offsetHeight } = this.#viewer;
    Object.assign(this.#box.style, { left: `${offsetLeft}px`, top: `${offsetTop}px` });
    this.#box.setAttribute("width", String(offsetWidth));
    this.#box.setAttribute("height", String(offsetHeight));
    this.#placeMarks();
  }

  #add(tag: string, className: string): SVGElement {
    const element = document.createElementNS(SVG, tag);
    element.setAttribute("class", className);
    this.#box.append(element);
    return element as SVGElement;
  }
}
