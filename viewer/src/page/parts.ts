/** The panel of parts: a flat list or the tree, and the selected parts below it. */

import { Branches } from "./branches";
import type { CleaveViewer } from "../component/element";
import { byId } from "./dom";
import { PartList } from "./list";
import type { RowPanel } from "./row_panel";
import { idOf, rowOf } from "./rows";
import { describeSelection } from "./selection";
import type { Session } from "./session";
import { plural } from "./text";

const KEPT_AS = "cleave.arrangement";

export class PartsPanel {
  readonly #viewer: CleaveViewer;
  readonly #session: () => Session | null;
  readonly #list: PartList;
  readonly #branches: Branches;
  #isTree = localStorage.getItem(KEPT_AS) === "tree";
  #shownSelection = "";

  constructor(viewer: CleaveViewer, session: () => Session | null) {
    this.#viewer = viewer;
    this.#session = session;
    this.#list = new PartList(viewer, session, () => this.#rename());
    this.#branches = new Branches(viewer, session, () => this.#rename());
    for (const id of ["list", "tree"]) this.#listenTo(byId(id));
    byId("show-all").addEventListener("click", () => session()?.showAll());
    byId("arrangement").addEventListener("change", (event) => this.#arrange((event.target as HTMLInputElement).value));
    this.#arrange(this.#isTree ? "tree" : "list");
  }

  update(): void {
    const session = this.#session();
    if (session === null) return;
    const { hidden } = session.work;
    byId("parts-heading").textContent = plural(session.parts.length, "part");
    byId("show-all").hidden = hidden.size === 0;
    byId("show-all").textContent = `Show ${hidden.size} hidden`;
    const focused = idOf(rowOf(document.activeElement));
    this.#shown.update();
    const { rows } = this.#shown;
    const stop = rows.get(focused) ?? rows.get(session.modes.selected[0] ?? -1) ?? rows.values().next().value;
    if (stop !== undefined) stop.tabIndex = 0;
    if (focused >= 0) stop?.focus({ preventScroll: true });
    describeSelection(session);
    this.#revealSelection(session);
  }

  /** Highlight the row of the part under the pointer. */
  highlight(part: number): void {
    for (const row of document.querySelectorAll("#side .is-hovered")) row.classList.remove("is-hovered");
    this.#shown.rows.get(part)?.classList.add("is-hovered");
  }

  get #shown(): RowPanel {
    return this.#isTree ? this.#branches : this.#list;
  }

  #arrange(name: string): void {
    this.#isTree = name === "tree";
    localStorage.setItem(KEPT_AS, name);
    byId("list-panel").hidden = this.#isTree;
    byId("tree").hidden = !this.#isTree;
    byId<HTMLInputElement>(`arrangement-${name}`).checked = true;
    this.#shownSelection = "";
    this.update();
  }

  #listenTo(rows: HTMLElement): void {
    const point = (event: Event) => (this.#viewer.hovered = this.#partAt(event.target));
    const leave = () => (this.#viewer.hovered = -1);
    rows.addEventListener("pointerover", point);
    rows.addEventListener("focusin", point);
    rows.addEventListener("pointerleave", leave);
    rows.addEventListener("focusout", leave);
    rows.addEventListener("dblclick", (event) => {
      if (rowOf(event.target) !== null) this.#rename();
    });
  }

  /** Focus the name field of the selected part. */
  #rename(): void {
    this.update(); // shows the field
    byId<HTMLInputElement>("part-name").select();
  }

  #partAt(target: EventTarget | null): number {
    const id = idOf(rowOf(target));
    return id >= 0 && this.#session()?.work.cut.has(id) === false ? id : -1;
  }

  #revealSelection(session: Session): void {
    const key = session.modes.selected.join(".");
    if (key !== this.#shownSelection && key !== "")
      this.#shown.rows.get(session.modes.selected.at(-1)!)?.scrollIntoView({ block: "nearest" });
    this.#shownSelection = key;
  }
}
