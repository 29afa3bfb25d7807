/** The tree of parts: expanding a part splits it, collapsing a group merges it. */

import type { CleaveViewer } from "../component/element";
import { h, icon } from "./dom";
import { focusRow, RowPanel } from "./row_panel";
import { eye, partCells } from "./rows";
import type { Session } from "./session";
import { plural, share } from "./text";

const DEEPEST_STEP = 7; // deeper rows are not indented further

export class Branches extends RowPanel {
  constructor(viewer: CleaveViewer, session: () => Session | null, onRename: () => void) {
    super("tree", viewer, session, onRename);
  }

  /** Show the nodes of the present cut. */
  update(): void {
    const session = this.session();
    if (session === null) return;
    this.rows.clear();
    // The root is omitted: it always contains all parts.
    session.tree.walkShown(session.work.cut, (id, isPart, depth) => {
      if (isPart || id > 0) this.rows.set(id, this.#row(session, id, isPart, Math.max(depth - 1, 0)));
    });
    this.box.replaceChildren(...this.rows.values());
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
      ...(isPart ? partCells(this.viewer, session, id) : groupCells(session, id, isHidden)),
    );
    row.style.setProperty("--depth", String(Math.min(depth, DEEPEST_STEP)));
    return row;
  }

  protected override press(session: Session, id: number, on: Element): boolean {
    if (on.closest(".twist") === null) return false;
    if (session.work.cut.has(id)) session.mergeBelow(id);
    else session.split([id]);
    return true;
  }

  protected override keysOf(session: Session, id: number, row: HTMLElement): Record<string, () => void> {
    const isOpen = session.work.cut.has(id);
    return {
      ArrowRight: () => (isOpen ? focusRow(row.nextElementSibling) : session.split([id])),
      ArrowLeft: () => (isOpen ? session.mergeBelow(id) : focusRow(this.rows.get(session.tree.groupOf(id)) ?? null)),
    };
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
