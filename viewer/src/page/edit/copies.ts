/** Parts that are copies of each other: found by the server, named and coloured together. */

import { jobPath, requestJson } from "../api";
import { announce, byId, toast } from "../dom";
import { explain, problemOf } from "../problems";
import type { Session } from "../session";
import { plural } from "../text";
import type { Editor, EditorHost } from "./editor";

const PAUSE_MS = 500; // before the server compares the parts of a level, which may be one of many on the way
const KEPT_AS = "cleave.copies";

interface Copy {
  readonly part: number;
  readonly related_color: string;
}

type Repeats = readonly { readonly copies: readonly Copy[] }[];

export class Copies {
  readonly #host: EditorHost;
  readonly #editor: Editor;
  readonly #toggle = byId<HTMLButtonElement>("find-copies");
  #isOn = localStorage.getItem(KEPT_AS) === "on";
  /** What the server has found for the path that was asked for last; null while it has not answered. */
  #repeats: Repeats | null = null;
  /** Of the job and the parts that were asked for last. */
  #asked = "";
  #asking = new AbortController();

  constructor(host: EditorHost, editor: Editor) {
    this.#host = host;
    this.#editor = editor;
    this.#toggle.addEventListener("click", () => this.#switch(!this.#isOn));
    byId("select-copies").addEventListener("click", () => this.#select());
    byId("color-copies").addEventListener("click", () => this.#color());
  }

  /** Ask for the copies among the shown parts if they are others than before. */
  update(): void {
    const [job, session] = [this.#host.job(), this.#host.session()];
    this.#toggle.setAttribute("aria-pressed", String(this.#isOn));
    if (job === null || session === null) return;
    this.#describe(session);
    const path = jobPath(job.id, `/parts${session.query}`);
    if (!this.#isOn) return;
    if (path === this.#asked) return this.#show(session);
    this.#asking.abort();
    this.#asked = path;
    this.#repeats = null;
    this.#asking = new AbortController();
    const { signal } = this.#asking;
    setTimeout(() => void this.#ask(path, signal), PAUSE_MS);
  }

  #switch(isOn: boolean): void {
    this.#isOn = isOn;
    localStorage.setItem(KEPT_AS, isOn ? "on" : "off");
    if (!isOn) this.#forget();
    this.update();
  }

  #forget(): void {
    this.#asking.abort();
    this.#asked = "";
    this.#repeats = null;
    this.#host.session()?.showCopies([]);
  }

  /** Show what is known in a session that does not know it. */
  #show(session: Session): void {
    if (this.#repeats === null || session.knowsCopies) return;
    session.showCopies(this.#repeats.map(({ copies }) => copies.map(({ part }) => part)));
  }

  async #ask(path: string, signal: AbortSignal): Promise<void> {
    if (signal.aborted) return;
    this.#toggle.setAttribute("aria-busy", "true");
    try {
      const { repeats } = await requestJson<{ readonly repeats: Repeats }>(path, { signal });
      if (signal.aborted) return;
      this.#repeats = repeats;
      this.update();
      announce(repeats.length === 0 ? "No parts are equal." : `${plural(repeats.length, "group")} of equal parts.`);
    } catch (error) {
      if (!signal.aborted) toast(explain(problemOf(error)).title);
    } finally {
      this.#toggle.removeAttribute("aria-busy");
    }
  }

  /** Offer what can be done with all copies of the selected parts. */
  #describe(session: Session): void {
    const { selected } = session.modes;
    const copies = selected[0] === undefined ? [] : session.copiesOf(selected[0]);
    byId("copies").hidden = copies.length === 0 || selected.some((id) => !copies.includes(id));
    byId("select-copies").hidden = selected.length === copies.length;
    byId("select-copies").textContent = `Select all ${copies.length} equal parts`;
  }

  #select(): void {
    const session = this.#host.session();
    const [first] = session?.modes.selected ?? [];
    if (session === null || first === undefined) return;
    session.setModes({ selected: session.copiesOf(first) });
    byId<HTMLInputElement>("part-name").focus();
  }

  #color(): void {
    const session = this.#host.session();
    const part = session?.numbersOf(session.modes.selected)[0];
    const group = this.#repeats?.find(({ copies }) => copies.some((copy) => copy.part === part));
    if (group === undefined) return;
    const operations = group.copies.map(({ part, related_color: color }) => ({ op: "color", part, color }) as const);
    void this.#editor.edit(operations, "Related colours");
  }
}
