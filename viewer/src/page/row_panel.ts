/** What the list and the tree of parts share: clicks and keys on their rows. */

import type { CleaveViewer } from "../component/element";
import { byId } from "./dom";
import { idOf, rowOf, select, toggleHidden } from "./rows";
import type { Session } from "./session";

export abstract class RowPanel {
  readonly rows = new Map<number, HTMLElement>();
  protected readonly box: HTMLElement;
  protected readonly viewer: CleaveViewer;
  protected readonly session: () => Session | null;
  readonly #onRename: () => void;

  /** ``id`` is that of the element that contains the rows. */
  constructor(id: string, viewer: CleaveViewer, session: () => Session | null, onRename: () => void) {
    this.box = byId(id);
    this.viewer = viewer;
    this.session = session;
    this.#onRename = onRename;
    this.box.addEventListener("click", (event) => this.#click(event));
    this.box.addEventListener("keydown", (event) => this.#key(event));
  }

  /** Show the rows of the present cut. */
  abstract update(): void;

  /** Handle a click on something that only these rows have; returns whether it was one. */
  protected press(_session: Session, _id: number, _on: Element): boolean {
    return false;
  }

  /** Return the keys that only these rows have. */
  protected keysOf(_session: Session, _id: number, _row: HTMLElement): Record<string, () => void> {
    return {};
  }

  #click(event: MouseEvent): void {
    const [session, row] = [this.session(), rowOf(event.target)];
    if (session === null || row === null) return;
    const id = idOf(row);
    const parts = session.tree.partsBelow(session.work.cut, id);
    const on = event.target as Element;
    if (on.closest(".eye") !== null) toggleHidden(session, parts);
    else if (!this.press(session, id, on)) select(session, parts, event.shiftKey || event.ctrlKey || event.metaKey);
  }

  /** Handle a key as in the patterns listbox and tree view of the ARIA Authoring Practices. */
  #key(event: KeyboardEvent): void {
    const [session, row] = [this.session(), rowOf(event.target)];
    if (session === null || row === null || event.ctrlKey || event.metaKey || event.altKey) return;
    const id = idOf(row);
    const parts = session.tree.partsBelow(session.work.cut, id);
    const actions: Record<string, () => void> = {
      ArrowDown: () => focusRow(row.nextElementSibling),
      ArrowUp: () => focusRow(row.previousElementSibling),
      Home: () => focusRow(this.box.firstElementChild),
      End: () => focusRow(this.box.lastElementChild),
      Enter: () => select(session, parts, event.shiftKey),
      " ": () => select(session, parts, true),
      h: () => toggleHidden(session, parts),
      F2: () => {
        select(session, parts, false);
        this.#onRename();
      },
      ...this.keysOf(session, id, row),
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
