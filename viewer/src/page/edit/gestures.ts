/** Turns pointers, fingers and keys on the model into clicks and strokes of the chosen tool. */

import type { CleaveViewer, Point } from "../../component/element";
import type { Overlay } from "./overlay";
import type { Tool } from "./tool";

const CLICK_PIXELS = 5; // a pointer that moves farther drags
const KEY_STEP = 8; // CSS pixels
const ARROWS: Readonly<Record<string, Point>> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class Gestures {
  readonly #viewer: CleaveViewer;
  readonly #overlay: Overlay;
  readonly #tool: () => Tool | null;
  /** The pointer whose stroke or click is in progress. */
  #pointer: number | null = null;
  #from: Point = [0, 0];
  #isStroke = false;
  /** The crosshair of the keys; null while a pointer is used. */
  #cross: Point | null = null;

  constructor(viewer: CleaveViewer, overlay: Overlay, tool: () => Tool | null) {
    this.#viewer = viewer;
    this.#overlay = overlay;
    this.#tool = tool;
    // In the capture phase: the controls of the camera are to know first whether a press is theirs.
    viewer.addEventListener("pointerdown", (event) => this.#down(event), { capture: true });
    viewer.addEventListener("pointermove", (event) => this.#move(event));
    viewer.addEventListener("pointerup", (event) => this.#up(event));
    viewer.addEventListener("pointercancel", () => this.cancel());
    viewer.addEventListener("pointerleave", () => overlay.disc(null, 0));
    viewer.addEventListener("keydown", (event) => this.#key(event), { capture: true });
  }

  /** Drop a stroke that is in progress. */
  cancel(): boolean {
    const wasStroke = this.#isStroke;
    if (wasStroke) this.#tool()?.drop();
    this.#isStroke = false;
    this.#pointer = null;
    return wasStroke;
  }

  /** Forget the crosshair, after another tool was chosen. */
  rest(): void {
    this.cancel();
    this.#cross = null;
    this.#overlay.crosshair(null);
  }

  #down(event: PointerEvent): void {
    const tool = this.#tool();
    if (tool === null) return;
    this.#cross = null;
    this.#overlay.crosshair(null);
    const point = this.#pointOf(event);
    if (this.#pointer !== null) {
      this.cancel(); // a second finger turns the model
      return;
    }
    const isStroke = tool.draws === "strokes" && event.button === 0 && (tool.beginsAnywhere || this.#viewer.sight!.at(point) >= 0);
    this.#viewer.isDrawing = isStroke || (tool.draws === "strokes" && event.button !== 0);
    if (event.button !== 0) return;
    this.#pointer = event.pointerId;
    this.#from = point;
    this.#isStroke = isStroke;
    if (isStroke) tool.begin?.(point);
  }

  #move(event: PointerEvent): void {
    const tool = this.#tool();
    if (tool === null) return;
    const point = this.#pointOf(event);
    if (tool.radius > 0 && event.pointerType !== "touch") this.#overlay.disc(point, tool.radius);
    if (!this.#isStroke || event.pointerId !== this.#pointer) return;
    const moves = event.getCoalescedEvents();
    tool.move?.(moves.length > 0 ? moves.map((move) => this.#pointOf(move)) : [point]);
  }

  #up(event: PointerEvent): void {
    const tool = this.#tool();
    if (tool === null || event.pointerId !== this.#pointer) return;
    const point = this.#pointOf(event);
    this.#pointer = null;
    if (this.#isStroke) {
      this.#isStroke = false;
      tool.finish?.();
    } else if (tool.draws === "clicks" && Math.hypot(point[0] - this.#from[0], point[1] - this.#from[1]) <= CLICK_PIXELS) {
      tool.click?.(point, event.altKey);
    }
  }

  /** Handle the keys of the crosshair: Shift and arrows move it, Space clicks, or begins and ends a stroke. */
  #key(event: KeyboardEvent): void {
    const tool = this.#tool();
    if (tool === null || event.ctrlKey || event.metaKey) return;
    const arrow = ARROWS[event.key];
    if (arrow !== undefined && (event.shiftKey || this.#isStroke)) this.#moveCross(tool, arrow);
    else if (event.key === " ") this.#press(tool, event.altKey);
    else if (event.key !== "Enter" || tool.apply?.() !== true) return;
    event.preventDefault();
    event.stopPropagation();
  }

  #press(tool: Tool, isMinus: boolean): void {
    const point = this.#crosshair();
    if (tool.draws === "clicks") return tool.click?.(point, isMinus);
    this.#isStroke = !this.#isStroke;
    if (this.#isStroke) tool.begin?.(point);
    else tool.finish?.();
  }

  #moveCross(tool: Tool, [right, down]: Point): void {
    const { clientWidth: width, clientHeight: height } = this.#viewer;
    const [x, y] = this.#crosshair();
    this.#cross = [clamp(x + right * KEY_STEP, width), clamp(y + down * KEY_STEP, height)];
    this.#overlay.crosshair(this.#cross);
    this.#overlay.disc(tool.radius > 0 ? this.#cross : null, tool.radius);
    if (this.#isStroke) tool.move?.([this.#cross]);
  }

  /** Return the crosshair, which begins in the middle. */
  #crosshair(): Point {
    this.#cross ??= [Math.round(this.#viewer.clientWidth / 2), Math.round(this.#viewer.clientHeight / 2)];
    this.#overlay.crosshair(this.#cross);
    return this.#cross;
  }

  #pointOf({ clientX, clientY }: PointerEvent): Point {
    const { left, top } = this.#viewer.getBoundingClientRect();
    return [clientX - left, clientY - top];
  }
}

function clamp(value: number, size: number): number {
  return Math.min(Math.max(value, 0), size - 1);
}
