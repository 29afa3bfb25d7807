/** Finds the part that is meant by clicks inside and outside of it. */

import { nodeOfPart, type Point } from "../../component/element";
import { announce, byId, h, toast } from "../dom";
import { problemOf } from "../problems";
import { plural } from "../text";
import { runsOf } from "./face_runs";
import type { Mark } from "./overlay";
import type { Operation } from "./revisions";
import { facesOf, type Desk, type Tool } from "./tool";

const PAUSE_MS = 40; // after a click, before the server is asked

export class PartTool implements Tool {
  readonly id = "part";
  readonly hint = "Click in a part; click with − or Alt where it is too much.";
  readonly draws = "clicks";
  readonly radius = 0;
  readonly beginsAnywhere = false;
  readonly #desk: Desk;
  readonly #minus = h("button", { type: "button", "aria-pressed": false, title: "Clicks mark what does not belong to the part (Alt)" }, "− Outside");
  readonly #plus = h("button", { type: "button", "aria-pressed": true, title: "Clicks mark what belongs to the part" }, "+ Inside");
  readonly #apply = h("button", { type: "button", className: "primary", disabled: true, title: "Enter" }, "Make it a part");
  readonly #drop = h("button", { type: "button", disabled: true, title: "Escape" }, "Drop");
  readonly options = [this.#plus, this.#minus, this.#apply, this.#drop];
  #marks: Mark[] = [];
  #asking: AbortController | null = null;
  #isFound = false;

  constructor(desk: Desk) {
    this.#desk = desk;
    for (const [button, isMinus] of [[this.#plus, false], [this.#minus, true]] as const)
      button.addEventListener("click", () => this.#press(isMinus));
    this.#apply.addEventListener("click", () => this.apply());
    this.#drop.addEventListener("click", () => this.drop());
  }

  update(): void {
    this.#desk.overlay.marks(this.#marks);
    if (this.#marks.length > 0) this.#ask();
  }

  click(point: Point, isMinus: boolean): void {
    const face = facesOf(this.#desk).at(point);
    if (face < 0) return;
    const kind = isMinus !== (this.#minus.getAttribute("aria-pressed") === "true");
    if (kind && !this.#marks.some((mark) => !mark.isMinus)) return announce("Mark a face inside of the part first.");
    this.#marks = [...this.#marks.filter((mark) => mark.face !== face), { face, isMinus: kind }];
    this.#desk.overlay.marks(this.#marks);
    this.#drop.disabled = false;
    this.#ask();
  }

  apply(): boolean {
    if (!this.#isFound) return false;
    const [inside] = this.#marks;
    const { editor } = this.#desk;
    const operation = this.#operation();
    this.#forget();
    void editor.edit([operation], "The part is stored").then((isStored) => {
      const session = this.#desk.session();
      if (isStored && session !== null) session.setModes({ selected: [nodeOfPart(editor.labels![inside!.face]!, editor.parts.length)] });
    });
    return true;
  }

  drop(): boolean {
    if (this.#marks.length === 0) return false;
    this.#forget();
    this.#desk.editor.drop();
    announce("Marks dropped.");
    return true;
  }

  #press(isMinus: boolean): void {
    this.#minus.setAttribute("aria-pressed", String(isMinus));
    this.#plus.setAttribute("aria-pressed", String(!isMinus));
  }

  #forget(): void {
    this.#asking?.abort();
    this.#marks = [];
    this.#isFound = false;
    this.#apply.disabled = this.#drop.disabled = true;
    this.#press(false);
    this.#desk.overlay.marks([]);
  }

  #operation(): Operation {
    const faces = (isMinus: boolean) => runsOf(this.#marks.filter((mark) => mark.isMinus === isMinus).map(({ face }) => face));
    return { op: "part", inside: faces(false), outside: faces(true), to: "new" };
  }

  /** Show the part of the present marks, unless there are newer ones when the answer arrives. */
  #ask(): void {
    this.#asking?.abort();
    const { signal } = (this.#asking = new AbortController());
    byId("tool-bar").setAttribute("aria-busy", "true");
    setTimeout(() => {
      if (!signal.aborted) void this.#preview(signal);
    }, PAUSE_MS);
  }

  async #preview(signal: AbortSignal): Promise<void> {
    const { editor } = this.#desk;
    try {
      const found = await editor.preview([this.#operation()], signal);
      if (signal.aborted) return;
      const part = found.labels[this.#marks[0]!.face]!;
      editor.show(found, part);
      this.#isFound = true;
      this.#apply.disabled = false;
      announce(`Part of ${plural(found.parts[part]!.faces, "face")}. Enter makes it a part.`);
    } catch (error) {
      if (signal.aborted) return;
      toast(problemOf(error).detail);
    }
    byId("tool-bar").removeAttribute("aria-busy");
  }
}
