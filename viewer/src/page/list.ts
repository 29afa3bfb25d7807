/** The flat list of parts: searched, and sorted by number, size or name. */

import type { CleaveViewer } from "../component/element";
import { byId, h } from "./dom";
import { RowPanel } from "./row_panel";
import { partCells } from "./rows";
import type { Session } from "./session";

const byName = new Intl.Collator("en", { numeric: true, sensitivity: "base" });

const ORDERS: Record<string, (session: Session) => (a: number, b: number) => number> = {
  number: () => () => 0, // the parts of a session are in the order of their numbers
  size: ({ tree }) => (a, b) => tree.node(b).area - tree.node(a).area,
  name: (session) => (a, b) => byName.compare(session.nameOf(a), session.nameOf(b)),
};

export class PartList extends RowPanel {
  readonly #search = byId<HTMLInputElement>("part-search");
  readonly #sort = byId<HTMLSelectElement>("part-sort");

  constructor(viewer: CleaveViewer, session: () => Session | null, onRename: () => void) {
    super("list", viewer, session, onRename);
    this.#search.addEventListener("input", () => this.update());
    this.#sort.addEventListener("change", () => this.update());
  }

  /** Show the parts of the present cut that match the search. */
  update(): void {
    const session = this.session();
    if (session === null) return;
    const wanted = this.#search.value.trim().toLowerCase();
    const parts = session.parts.filter((id) => matches(session, id, wanted)).sort(ORDERS[this.#sort.value]!(session));
    this.rows.clear();
    for (const id of parts) this.rows.set(id, this.#row(session, id));
    this.box.replaceChildren(...this.rows.values());
    this.box.hidden = parts.length === 0;
    byId("no-parts").hidden = parts.length > 0;
  }

  #row(session: Session, id: number): HTMLElement {
    const className = session.work.hidden.has(id) ? "row is-hidden" : "row";
    const isSelected = session.modes.selected.includes(id);
    const row = h("div", { className, role: "option", tabIndex: -1, "data-id": id, "aria-selected": isSelected });
    row.append(...partCells(this.viewer, session, id).filter((cell) => cell !== null));
    return row;
  }
}

function matches(session: Session, id: number, wanted: string): boolean {
  return wanted === "" || String(session.numberOf(id)) === wanted || session.nameOf(id).toLowerCase().includes(wanted);
}
