/** The toolbar of the 3D view, the actions on selected parts, and their keyboard shortcuts. */

import type { CleaveViewer, Look, View } from "../component/element";
import { announce, byId, openDialog, toast } from "./dom";
import { toggleHidden } from "./rows";
import { sharedName } from "./selection";
import { LOOKS, type Modes, type Session } from "./session";

type Toggle = "wireframe" | "concavity" | "lines";

export class Tools {
  readonly #viewer: CleaveViewer;
  readonly #session: () => Session | null;
  readonly #onMerge: (parts: readonly number[]) => void;
  readonly #explode = byId<HTMLInputElement>("explode");
  /** The camera before parts were isolated; null if none are. */
  #before: { session: Session; view: View } | null = null;

  constructor(viewer: CleaveViewer, session: () => Session | null, onMerge: (parts: readonly number[]) => void) {
    this.#viewer = viewer;
    this.#session = session;
    this.#onMerge = onMerge;
    const toggle = (name: Toggle) => () => this.#with((now) => now.setModes({ [name]: !now.modes[name] }));
    const actions: Record<string, () => void> = {
      undo: () => this.#with((now) => now.undo()),
      redo: () => this.#with((now) => now.redo()),
      "reset-view": () => viewer.resetView(),
      wireframe: toggle("wireframe"),
      concavity: toggle("concavity"),
      lines: toggle("lines"),
      up: () => this.#with((now) => now.setModes({ up: now.modes.up === "y" ? "z" : "y" })),
      split: () => this.#split(),
      merge: () => this.#merge(),
      hide: () => this.#hide(),
      isolate: () => this.#isolate(),
    };
    for (const [id, action] of Object.entries(actions)) byId(id).addEventListener("click", action);
    this.#explode.addEventListener("input", () =>
      this.#with((now) => now.setModes({ explode: this.#explode.valueAsNumber / 100 })),
    );
    byId("open-view").addEventListener("click", () => {
      const isOpen = byId("stage").classList.toggle("is-view-open");
      byId("open-view").setAttribute("aria-expanded", String(isOpen));
    });
    this.#listenToLook();
    this.#listenToName();
    viewer.addEventListener("keydown", (event) => this.#key(event));
    document.addEventListener("keydown", (event) => this.#undoKey(event));
  }

  update(): void {
    const session = this.#session();
    if (session === null) return;
    const { modes } = session;
    byId<HTMLButtonElement>("undo").disabled = !session.canUndo;
    byId<HTMLButtonElement>("redo").disabled = !session.canRedo;
    for (const name of ["wireframe", "concavity", "lines"] as const) press(name, modes[name]);
    press("up", modes.up === "z");
    for (const choice of byId("look").querySelectorAll("input")) choice.checked = choice.value === modes.look;
    this.#explode.value = String(Math.round(100 * modes.explode));
    this.#explode.setAttribute("aria-valuetext", `${this.#explode.value} %`);
    applyModes(this.#viewer, modes);
    this.#returnFromIsolated(session);
  }

  /** Return to the camera before parts were isolated when all parts are shown again. */
  #returnFromIsolated(session: Session): void {
    if (this.#before === null || session.work.hidden.size > 0) return;
    if (this.#before.session === session) this.#viewer.view = this.#before.view;
    this.#before = null;
  }

  #with(act: (session: Session) => void): void {
    const session = this.#session();
    if (session !== null) act(session);
  }

  #split(): void {
    this.#with((now) => now.split(now.modes.selected));
  }

  #merge(): void {
    this.#with((now) => this.#onMerge(now.modes.selected));
  }

  #hide(): void {
    this.#with((now) => {
      const { selected } = now.modes;
      if (selected.length > 0) toggleHidden(now, selected);
    });
  }

  #isolate(): void {
    this.#with((now) => {
      const { selected } = now.modes;
      if (selected.length === 0) return;
      this.#before ??= { session: now, view: this.#viewer.view };
      now.isolate(selected);
      this.#viewer.focusOn(selected);
    });
  }

  #listenToLook(): void {
    const choices = byId("look");
    choices.addEventListener("change", (event) => this.#choose((event.target as HTMLInputElement).value as Look));
    this.#viewer.addEventListener("cleave-look", () => choices.removeAttribute("aria-busy"));
    this.#viewer.addEventListener("cleave-look-error", (event) => {
      choices.removeAttribute("aria-busy");
      toast(`The original look is not there. ${(event as CustomEvent<{ message: string }>).detail.message}`);
      this.#choose("parts");
    });
  }

  #choose(look: Look): void {
    if (look !== "parts") byId("look").setAttribute("aria-busy", "true");
    this.#with((now) => now.setModes({ look }));
  }

  #nextLook(): void {
    this.#with((now) => {
      const look = LOOKS[(LOOKS.indexOf(now.modes.look) + 1) % LOOKS.length]!;
      this.#choose(look);
      announce(`Look: ${look}.`);
    });
  }

  #listenToName(): void {
    const name = byId<HTMLInputElement>("part-name");
    const rename = () =>
      this.#with((now) => {
        const { selected } = now.modes;
        if (selected.length > 0 && name.value !== sharedName(now)) now.rename(selected, name.value);
      });
    name.addEventListener("change", rename);
    name.addEventListener("keydown", (event) => {
      if (event.key === "Enter") name.blur();
    });
  }

  /** Handle a key while the 3D view has the focus. */
  #key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const step = (by: 1 | -1) => this.#with((now) => now.showStep(by));
    const actions: Record<string, () => void> = {
      s: () => this.#split(),
      m: () => this.#merge(),
      h: () => this.#hide(),
      i: () => this.#isolate(),
      a: () => this.#with((now) => now.showAll()),
      w: () => byId("wireframe").click(),
      l: () => byId("lines").click(),
      c: () => byId("concavity").click(),
      o: () => this.#nextLook(),
      ",": () => step(-1),
      ".": () => step(1),
      "?": () => openDialog(byId<HTMLDialogElement>("keys")),
    };
    const action = actions[event.key];
    if (action === undefined) return;
    event.preventDefault();
    action();
  }

  #undoKey(event: KeyboardEvent): void {
    const isTyping = event.target instanceof HTMLInputElement && event.target.type !== "range";
    if (!(event.ctrlKey || event.metaKey) || isTyping || document.querySelector("dialog[open]") !== null) return;
    const key = event.key.toLowerCase();
    if (key !== "z" && key !== "y") return;
    event.preventDefault();
    this.#with((now) => (key === "y" || event.shiftKey ? now.redo() : now.undo()));
  }
}

/** Apply the display modes to a viewer. */
export function applyModes(viewer: CleaveViewer, modes: Modes): void {
  viewer.toggleAttribute("wireframe", modes.wireframe);
  viewer.toggleAttribute("concavity", modes.concavity);
  viewer.toggleAttribute("no-lines", !modes.lines);
  viewer.setAttribute("up", modes.up);
  viewer.setAttribute("look", modes.look);
  viewer.setAttribute("explode", String(modes.explode));
}

function press(id: string, isPressed: boolean): void {
  byId(id).setAttribute("aria-pressed", String(isPressed));
}
