/** The part that a brush or a lasso moves faces to. */

import { h } from "../dom";
import { plural } from "../text";
import type { Target } from "./revisions";
import { selectedParts, type Desk } from "./tool";

/** ``start`` is the part in which a stroke begins. */
export type Choice = Target | "start";

export class TargetChoice {
  readonly element: HTMLSelectElement;
  readonly #desk: Desk;
  readonly #hasStart: boolean;
  #selection = "";

  constructor(desk: Desk, hasStart: boolean) {
    this.#desk = desk;
    this.#hasStart = hasStart;
    this.element = h("select", { "aria-label": "Move faces to" });
  }

  get value(): Choice {
    const { value } = this.element;
    return value === "start" || value === "new" ? value : Number(value);
  }

  set value(value: Choice) {
    this.element.value = String(value);
  }

  /** Offer the present parts, and choose the selected one after the selection has changed. */
  update(): void {
    const session = this.#desk.session();
    if (session === null) return;
    const before = this.element.value;
    const option = (value: string, text: string) => h("option", { value }, text);
    this.element.replaceChildren(
      ...(this.#hasStart ? [option("start", "The part where it begins")] : []),
      option("new", "A new part"),
      ...session.parts.map((id, part) => option(String(part), session.nameOf(id))),
    );
    const selected = selectedParts(this.#desk);
    const key = selected.join();
    const first = this.#hasStart ? "start" : "new";
    if (key !== this.#selection && selected.length < 2) this.element.value = String(selected[0] ?? first);
    else this.element.value = before;
    if (this.element.value === "") this.element.value = first;
    this.#selection = key;
  }
}

/** Return the faces that may move to a part, and what was done in words. */
export function movable({ editor }: Desk, faces: readonly number[], part: number): number[] {
  return faces.filter((face) => {
    const own = editor.labels![face]!;
    return own !== part && !editor.parts[own]!.locked;
  });
}

export const moved = (faces: number): string => `${plural(faces, "face")} moved`;
