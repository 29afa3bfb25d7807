/** Class, colour and lock of the selected parts. */

import type { CleaveViewer } from "../../component/element";
import { announce, byId, h } from "../dom";
import type { Session } from "../session";
import { partOfLevel } from "./automatic";
import { classes } from "./classes";
import { EditedSession } from "./edited_session";
import type { Editor } from "./editor";
import type { Operation, Part } from "./revisions";

const MANY = "\u0000"; // parts of different classes

export class Described {
  readonly #viewer: CleaveViewer;
  readonly #editor: Editor;
  readonly #session: () => Session | null;
  readonly #class = byId<HTMLSelectElement>("part-class");
  readonly #color = byId<HTMLInputElement>("part-color");
  readonly #lock = byId<HTMLButtonElement>("part-lock");

  constructor(viewer: CleaveViewer, editor: Editor, session: () => Session | null) {
    this.#viewer = viewer;
    this.#editor = editor;
    this.#session = session;
    this.#class.addEventListener("change", () => this.#classify(this.#class.value));
    this.#color.addEventListener("change", () => this.#send((part) => [{ op: "color", part, color: this.#color.value }], "Colour changed"));
    this.#lock.addEventListener("click", () => this.toggleLock());
    viewer.addEventListener("keydown", (event) => this.#key(event));
  }

  update(): void {
    const numbers = this.#numbers();
    if (numbers.length === 0) return;
    const parts = numbers.map((part) => this.#details(part));
    const names = [...new Set([...classes(), ...parts.map((part) => part.class).filter((name) => name !== "")])];
    const shared = parts.every((part) => part.class === parts[0]!.class) ? parts[0]!.class : MANY;
    this.#class.replaceChildren(
      h("option", { value: "" }, "No class"),
      ...names.map((name, i) => h("option", { value: name }, i < 9 ? `${i + 1} ${name}` : name)),
      ...(shared === MANY ? [h("option", { value: MANY, disabled: true }, "Several")] : []),
    );
    this.#class.value = shared;
    this.#color.value = parts[0]!.color;
    const isLocked = parts.every(({ locked }) => locked);
    this.#lock.setAttribute("aria-pressed", String(isLocked));
    this.#lock.querySelector("span")!.textContent = isLocked ? "Unlock" : "Lock";
  }

  toggleLock(): void {
    const op = this.#lock.getAttribute("aria-pressed") === "true" ? "unlock" : "lock";
    this.#send((part) => [{ op, part }], op === "lock" ? "Locked" : "Unlocked");
  }

  #classify(name: string): void {
    this.#send((part): Operation[] => {
      const isNamed = name === "" || this.#details(part).name !== "";
      return [{ op: "class", part, class: name === "" ? null : name }, ...(isNamed ? [] : [{ op: "name", part, name } as const])];
    }, name === "" ? "Class removed" : `Class ${name}`);
  }

  /** Handle the keys 1 to 9, which give the selected parts a class, and U, which locks them. */
  #key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey || this.#numbers().length === 0) return;
    if (event.key === "u") return this.toggleLock();
    if (!/^[1-9]$/.test(event.key)) return;
    const name = classes()[Number(event.key) - 1];
    if (name === undefined) announce(`There is no class ${event.key}: add it in Labels.`);
    else this.#classify(name);
  }

  #send(operationsOf: (part: number) => Operation[], done: string): void {
    const operations = this.#numbers().flatMap(operationsOf);
    if (operations.length > 0) void this.#editor.edit(operations, done);
  }

  #details(part: number): Part {
    const session = this.#session()!;
    if (session instanceof EditedSession) return session.details[part]!;
    return partOfLevel(this.#viewer, session, session.parts[part]!);
  }

  #numbers(): number[] {
    const session = this.#session();
    return session === null ? [] : session.numbersOf(session.modes.selected);
  }
}
