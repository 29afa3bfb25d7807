/** The flat list of parts: searched, and sorted by number, size or name. */

import type { CleaveViewer } from "../component/element";
import { byId, h } from "./dom";
import { idOf, partCells, rowOf, select, toggleHidden } from "./rows";
import type { Session } from "./session";

const byName = new Intl.Collator("en", { numeric: true, sensitivity: "base" });

const ORDERS: Record<string, (session: Session) => (a: number, b: number) => number> = {
  number: () => () => 0, // the parts of a session are in the order of their numbers
  size: ({ tree }) => (a, b) => tree.node(b).area - tree.node(a).area,
  name: (session) => (a, b) => byName.compare(session.nameOf(a), session.nameOf(b)),
};

export class PartList {
  readonly #list = byId("list");
  readonly #search = byId<HTMLInputElement>("part-search");
  readonly #sort = byId<HTMLSelectElement>("part-sort");
  readonly #viewer: CleaveViewer;
  readonly #session: () => Session | null;
  readonly #onRename: () => void;
  readonly rows = new Map<number, HTMLElement>();

  constructor(viewer: CleaveViewer, session: () => Session | null, onRename: () => void) {
    this.#viewer = viewer;
    this.#session = session;
    this.#onRename = onRename;
    this.#search.addEventListener("input", () => this.update());
    this.#sort.addEventListener("change", () => this.update());
    this.#list.addEventListener("click", (event) => this.#click(event));
    this.#list.addEventListener("keydown", (event) => this.#key(event));
  }

  /** Show the parts of the present cut that match the search. */
  update(): void {
    const session = this.#session();
    if (session === null) return;
    const wanted = this.#search.value.trim().toLowerCase();
    const parts = session.parts.filter((id) => matches(session, id, wanted)).sort(ORDERS[this.#sort.value]!(session));
    this.rows.clear();
    for (const id of parts) this.rows.set(id, this.#row(session, id));
    this.#list.replaceChildren(...this.rows.values());
    this.#list.hidden = parts.length === 0;
    byId("no-parts").hidden = parts.length > 0;
  }

  #row(session: Session, id: number): HTMLElement {
    const className = session.work.hidden.has(id) ? "row is-hidden" : "row";
    const isSelected = session.modes.selected.includes(id);
    const row = h("div", { className, role: "option", tabIndex: -1, "data-id": id, "aria-selected": isSelected });
    row.append(...partCells(this.#viewer, session, id).filter((cell) => cell !== null));
    return row;
  }

  #click(event: MouseEvent): void {
    const [session, row] = [this.#session(), rowOf(event.target)];
    if (session === null || row === null) return;
    if ((event.target as Element).closest(".eye") !== null) toggleHidden(session, [idOf(row)]);
    else select(session, [idOf(row)], event.shiftKey || event.ctrlKey || event.metaKey);
  }

  /** Handle a key as in the listbox pattern of the ARIA Authoring Practices. */
  #key(event: KeyboardEvent): void {
    const [session, row] = [this.#session(), rowOf(event.target)];
    if (session === null || row === null || event.ctrlKey || event.metaKey || event.altKey) return;
    const id = idOf(row);
    const actions: Record<string, () => void> = {
      ArrowDown: () => focusRow(row.nextElementSibling),
      ArrowUp: () => focusRow(row.previousElementSibling),
      Home: () => focusRow(this.#list.firstElementChild),
      End: () => focusRow(this.#list.lastElementChild),
      Enter: () => select(session, [id], event.shiftKey),
      " ": () => select(session, [id], true),
      h: () => toggleHidden(session, [id]),
      F2: () => {
        select(session, [id], false);
        this.#onRename();
      },
    };
    const action = actions[event.key];
    if (action === undefined) return;
    event.preventDefault();
    action();
  }
}

/** Move the focus to a row; the others of its list are then left out when Tab is pressed. */
export function focusRow(row: Element | null): void {
  if (!(row instanceof HTMLElement)) return;
  for (const other of row.parentElement!.querySelectorAll<HTMLElement>("[tabindex='0']")) other.tabIndex = -1;
  row.tabIndex = 0;
  row.focus();
}

function matches(session: Session, id: number, wanted: string): boolean {
  return wanted === "" || String(session.numberOf(id)) === wanted || session.nameOf(id).toLowerCase().includes(wanted);
}
