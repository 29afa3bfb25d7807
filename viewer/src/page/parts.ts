/** The tree of parts: expanding a part splits it, collapsing a group merges it. */

import type { CleaveViewer } from "../component/element";
import { byId, h, icon } from "./dom";
import type { Session } from "./session";
import { count, figure, plural, share } from "./text";

const DEEPEST_STEP = 7; // deeper rows are not indented further

export class PartsPanel {
  readonly #list = byId("tree");
  readonly #heading = byId("parts-heading");
  readonly #detail = byId("detail");
  readonly #viewer: CleaveViewer;
  readonly #session: () => Session | null;
  readonly #rows = new Map<number, HTMLElement>();
  #shownSelection = "";

  constructor(viewer: CleaveViewer, session: () => Session | null) {
    this.#viewer = viewer;
    this.#session = session;
    this.#list.addEventListener("click", (event) => this.#click(event));
    this.#list.addEventListener("dblclick", (event) => {
      if (rowOf(event.target) !== null) this.#rename();
    });
    this.#list.addEventListener("pointerover", (event) => (viewer.hovered = this.#partAt(event.target)));
    this.#list.addEventListener("pointerleave", () => (viewer.hovered = -1));
    this.#list.addEventListener("focusin", (event) => (viewer.hovered = this.#partAt(event.target)));
    this.#list.addEventListener("focusout", () => (viewer.hovered = -1));
    this.#list.addEventListener("keydown", (event) => this.#key(event));
    byId("show-all").addEventListener("click", () => session()?.showAll());
  }

  update(): void {
    const session = this.#session();
    if (session === null) return;
    const { work, modes, tree } = session;
    this.#heading.textContent = plural(session.parts.length, "part");
    byId("show-all").hidden = work.hidden.size === 0;
    byId("show-all").textContent = `Show ${plural(work.hidden.size, "hidden part")}`;
    const focused = idOf(rowOf(document.activeElement));
    this.#rows.clear();
    // The root is omitted: it always contains all parts.
    tree.walkShown(work.cut, (id, isPart, depth) => {
      if (isPart || id > 0) this.#rows.set(id, this.#row(session, id, isPart, Math.max(depth - 1, 0)));
    });
    this.#list.replaceChildren(...this.#rows.values());
    const stop = this.#rows.get(focused) ?? this.#rows.get(modes.selected[0] ?? -1) ?? this.#rows.values().next().value;
    if (stop !== undefined) stop.tabIndex = 0;
    if (focused >= 0) stop?.focus({ preventScroll: true });
    this.#describeSelection(session);
    this.#revealSelection(session);
  }

  /** Highlight the row of the part under the pointer. */
  highlight(part: number): void {
    this.#list.querySelector(".is-hovered")?.classList.remove("is-hovered");
    this.#rows.get(part)?.classList.add("is-hovered");
  }

  #row(session: Session, id: number, isPart: boolean, depth: number): HTMLElement {
    const { tree, work, modes } = session;
    const node = tree.node(id);
    const isHidden = isPart ? work.hidden.has(id) : tree.partsBelow(work.cut, id).every((part) => work.hidden.has(part));
    const canSplit = node.children.length > 0;
    const name = session.nameOf(id);
    const size = plural(tree.partsBelow(work.cut, id).length, "part");
    const title = isPart ? name : name === "Group" ? size : `${name}, ${size}`;
    const swatch = h("span", { className: isPart ? "swatch" : "swatch is-group" });
    if (isPart) swatch.style.background = this.#viewer.colorOf(id);
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
      swatch,
      h("span", { className: isPart ? "name" : "name is-group" }, title),
      h("span", { className: "share" }, share(node.area / tree.totalArea)),
      isHidden && h("span", { className: "unseen" }, "hidden"),
      h(
        "span",
        { className: "eye", title: isHidden ? "Show" : "Hide", "aria-hidden": true },
        icon(isHidden ? "eye-off" : "eye"),
      ),
    );
    row.style.setProperty("--depth", String(Math.min(depth, DEEPEST_STEP)));
    return row;
  }

  #click(event: MouseEvent): void {
    const session = this.#session();
    const row = rowOf(event.target);
    if (session === null || row === null) return;
    const id = idOf(row);
    const on = event.target as Element;
    if (on.closest(".eye") !== null) this.#toggleHidden(session, id);
    else if (on.closest(".twist") !== null) this.#toggleCut(session, id);
    else this.#select(session, id, event.shiftKey || event.ctrlKey || event.metaKey);
  }

  #select(session: Session, id: number, isMore: boolean): void {
    const parts = session.tree.partsBelow(session.work.cut, id);
    const { selected } = session.modes;
    const rest = selected.filter((part) => !parts.includes(part));
    const isOut = isMore && parts.every((part) => selected.includes(part));
    session.setModes({ selected: isOut ? rest : isMore ? [...rest, ...parts] : parts });
  }

  #toggleCut(session: Session, id: number): void {
    if (session.work.cut.has(id)) session.mergeBelow(id);
    else session.split([id]);
  }

  #toggleHidden(session: Session, id: number): void {
    const parts = session.tree.partsBelow(session.work.cut, id);
    session.setHidden(parts, !parts.every((part) => session.work.hidden.has(part)));
  }

  /** Focus the name field of the selected part. */
  #rename(): void {
    this.update(); // shows the field
    byId<HTMLInputElement>("part-name").select();
  }

  /** Handle a key as in the tree view pattern of the ARIA Authoring Practices. */
  #key(event: KeyboardEvent): void {
    const session = this.#session();
    const row = rowOf(event.target);
    if (session === null || row === null || event.ctrlKey || event.metaKey || event.altKey) return;
    const id = idOf(row);
    const { tree, work } = session;
    const isOpen = work.cut.has(id);
    const actions: Record<string, () => void> = {
      ArrowDown: () => this.#focus(row.nextElementSibling),
      ArrowUp: () => this.#focus(row.previousElementSibling),
      Home: () => this.#focus(this.#list.firstElementChild),
      End: () => this.#focus(this.#list.lastElementChild),
      ArrowRight: () => (isOpen ? this.#focus(row.nextElementSibling) : session.split([id])),
      ArrowLeft: () => (isOpen ? session.mergeBelow(id) : this.#focus(this.#rows.get(tree.groupOf(id)) ?? null)),
      Enter: () => this.#select(session, id, event.shiftKey),
      " ": () => this.#select(session, id, true),
      h: () => this.#toggleHidden(session, id),
      F2: () => {
        this.#select(session, id, false);
        this.#rename();
      },
    };
    const action = actions[event.key];
    if (action === undefined) return;
    event.preventDefault();
    action();
  }

  #focus(row: Element | null): void {
    if (!(row instanceof HTMLElement)) return;
    for (const other of this.#rows.values()) other.tabIndex = -1;
    row.tabIndex = 0;
    row.focus();
  }

  #partAt(target: EventTarget | null): number {
    const id = idOf(rowOf(target));
    return id >= 0 && this.#session()?.work.cut.has(id) === false ? id : -1;
  }

  #revealSelection(session: Session): void {
    const key = session.modes.selected.join(".");
    if (key !== this.#shownSelection && key !== "") {
      this.#rows.get(session.modes.selected.at(-1)!)?.scrollIntoView({ block: "nearest" });
    }
    this.#shownSelection = key;
  }

  #describeSelection(session: Session): void {
    const { selected } = session.modes;
    this.#detail.hidden = selected.length === 0;
    if (selected.length === 0) return;
    const { tree, work } = session;
    const nodes = selected.map((id) => tree.node(id));
    const one = nodes.length === 1 ? nodes[0]! : null;
    const sum = (of: (node: (typeof nodes)[number]) => number) => nodes.reduce((total, node) => total + of(node), 0);
    const target = tree.commonAncestor(selected);
    const merged = tree.partsBelow(work.cut, target).length;
    const name = byId<HTMLInputElement>("part-name");
    name.hidden = one === null;
    byId("many-parts").hidden = one !== null;
    byId("many-parts").textContent = `${plural(selected.length, "part")} selected`;
    if (one !== null && document.activeElement !== name) name.value = session.nameOf(one.id);
    byId("detail-area").textContent = share(sum((node) => node.area) / tree.totalArea);
    byId("detail-faces").textContent = count(sum((node) => node.faces));
    byId("detail-made").textContent = one === null || one.parent < 0 ? "–" : figure(tree.node(one.parent).cutValue);
    byId("detail-next").textContent = one === null || one.children.length === 0 ? "–" : figure(one.cutValue);
    byId<HTMLButtonElement>("split").disabled = nodes.every((node) => node.children.length === 0);
    const merge = byId<HTMLButtonElement>("merge");
    merge.disabled = merged < 2;
    merge.querySelector("span")!.textContent = merged > selected.length ? `Merge ${merged}` : "Merge";
    merge.title = merged > selected.length ? `Merges the smallest group that contains the selection: ${merged} parts` : "";
    const isHidden = selected.every((id) => work.hidden.has(id));
    byId("hide").querySelector("span")!.textContent = isHidden ? "Show" : "Hide";
  }
}

function rowOf(target: EventTarget | null): HTMLElement | null {
  return target instanceof Element ? target.closest<HTMLElement>("#tree [role=treeitem]") : null;
}

function idOf(row: HTMLElement | null): number {
  return row === null ? -1 : Number(row.dataset["id"]);
}
