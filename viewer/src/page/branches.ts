/** The tree of parts: expanding a part splits it, collapsing a group merges it. */

import type { CleaveViewer } from "../component/element";
import { byId, h, icon } from "./dom";
import { focusRow } from "./list";
import { eye, idOf, partCells, rowOf, select, toggleHidden } from "./rows";
import type { Session } from "./session";
import { plural, share } from "./text";

const DEEPEST_STEP = 7; // deeper rows are not indented further

export class Branches {
  readonly #list = byId("tree");
  readonly #viewer: CleaveViewer;
  readonly #session: () => Session | null;
  readonly #onRename: () => void;
  readonly rows = new Map<number, HTMLElement>();

  constructor(viewer: CleaveViewer, session: () => Session | null, onRename: () => void) {
    this.#viewer = viewer;
    this.#session = session;
    this.#onRename = onRename;
    this.#list.addEventListener("click", (event) => this.#click(event));
    this.#list.addEventListener("keydown", (event) => this.#key(event));
  }

  /** Show the nodes of the present cut. */
  update(): void {
    const session = this.#session();
    if (session === null) return;
    this.rows.clear();
    // The root is omitted: it always contains all parts.
    session.tree.walkShown(session.work.cut, (id, isPart, depth) => {
      if (isPart || id > 0) this.rows.set(id, this.#row(session, id, isPart, Math.max(depth - 1, 0)));
    });
    this.#list.replaceChildren(...this.rows.values());
  }

  #row(session: Session, id: number, isPart: boolean, depth: number): HTMLElement {
    const { tree, work, modes } = session;
    const isHidden = tree.partsBelow(work.cut, id).every((part) => work.hidden.has(part));
    const canSplit = tree.node(id).children.length > 0;
    const row = h(
      "div",
      {
        className: isHidden ? "row is-hidden" : "row",
        role: "treeitem",
        tabIndex: -1,
        "data-id": id,
        "aria-level": depth + 1,
        "aria-selected": modes.selected.includes(id),
        ...(canSplit ? { "aria-expanded": !isPart } : {}),
      },
      h(
        "span",
        { className: canSplit ? "twist" : "twist is-leaf", title: isPart ? "Split" : "Merge", "aria-hidden": true },
        canSplit && icon("chevron"),
      ),
      ...(isPart ? partCells(this.#viewer, session, id) : groupCells(session, id, isHidden)),
    );
    row.style.setProperty("--depth", String(Math.min(depth, DEEPEST_STEP)));
    return row;
  }

  #click(event: MouseEvent): void {
    const [session, row] = [this.#session(), rowOf(event.target)];
    if (session === null || row === null) return;
    const id = idOf(row);
    const parts = session.tree.partsBelow(session.work.cut, id);
    const on = event.target as Element;
    if (on.closest(".eye") !== null) toggleHidden(session, parts);
    else if (on.closest(".twist") !== null) toggleCut(session, id);
    else select(session, parts, event.shiftKey || event.ctrlKey || event.metaKey);
  }

  /** Handle a key as in the tree view pattern of the ARIA Authoring Practices. */
  #key(event: KeyboardEvent): void {
    const [session, row] = [this.#session(), rowOf(event.target)];
    if (session === null || row === null || event.ctrlKey || event.metaKey || event.altKey) return;
    const id = idOf(row);
    const { tree, work } = session;
    const isOpen = work.cut.has(id);
    const parts = tree.partsBelow(work.cut, id);
    const actions: Record<string, () => void> = {
      ArrowDown: () => focusRow(row.nextElementSibling),
      ArrowUp: () => focusRow(row.previousElementSibling),
      Home: () => focusRow(this.#list.firstElementChild),
      End: () => focusRow(this.#list.lastElementChild),
      ArrowRight: () => (isOpen ? focusRow(row.nextElementSibling) : session.split([id])),
      ArrowLeft: () => (isOpen ? session.mergeBelow(id) : focusRow(this.rows.get(tree.groupOf(id)) ?? null)),
      Enter: () => select(session, parts, event.shiftKey),
      " ": () => select(session, parts, true),
      h: () => toggleHidden(session, parts),
      F2: () => {
        select(session, parts, false);
        this.#onRename();
      },
    };
    const action = actions[event.key];
    if (action === undefined) return;
    event.preventDefault();
    action();
  }
}

function groupCells(session: Session, id: number, isHidden: boolean): HTMLElement[] {
  const { tree, work } = session;
  const size = plural(tree.partsBelow(work.cut, id).length, "part");
  const name = work.names.get(id);
  return [
    h("span", { className: "name is-group" }, name === undefined ? size : `${name}, ${size}`),
    h("span", { className: "share" }, share(tree.node(id).area / tree.totalArea)),
    eye(isHidden),
  ];
}

function toggleCut(session: Session, id: number): void {
  if (session.work.cut.has(id)) session.mergeBelow(id);
  else session.split([id]);
}
