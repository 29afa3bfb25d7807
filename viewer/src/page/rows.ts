/** The rows of parts that the list and the tree share. */

import type { CleaveViewer } from "../component/element";
import { h, icon } from "./dom";
import type { Session } from "./session";
import { share } from "./text";

/** Share of the area below which a part is called tiny; set by hand. */
const TINY = 0.001;

/** Return what a row shows of a part: colour, name, number, flags, share of the area, and the eye that hides it. */
export function partCells(viewer: CleaveViewer, session: Session, id: number): (HTMLElement | null)[] {
  const { tree, work } = session;
  const isHidden = work.hidden.has(id);
  const part = tree.node(id).area / tree.totalArea;
  const copies = session.copiesOf(id).length;
  const swatch = h("span", { className: "swatch" });
  swatch.style.background = viewer.colorOf(id);
  return [
    swatch,
    h("span", { className: "name" }, session.nameOf(id)),
    work.names.has(id) ? h("span", { className: "number", title: "Number of the part" }, String(session.numberOf(id))) : null,
    copies > 0 ? h("span", { className: "flag", title: `${copies} equal parts` }, `×${copies}`) : null,
    part < TINY ? h("span", { className: "flag", title: "Less than a thousandth of the area" }, "tiny") : null,
    isHidden ? h("span", { className: "flag" }, "hidden") : null,
    h("span", { className: "share" }, share(part)),
    eye(isHidden),
  ];
}

export function eye(isHidden: boolean): HTMLElement {
  return h(
    "span",
    { className: "eye", title: isHidden ? "Show" : "Hide", "aria-hidden": true },
    icon(isHidden ? "eye-off" : "eye"),
  );
}

/** Select what a row stands for; ``isMore`` adds it to the selection or takes it out. */
export function select(session: Session, parts: readonly number[], isMore: boolean): void {
  const { selected } = session.modes;
  const rest = selected.filter((other) => !parts.includes(other));
  const isOut = isMore && rest.length === selected.length - parts.length;
  session.setModes({ selected: isOut ? rest : isMore ? [...rest, ...parts] : parts });
}

export function toggleHidden(session: Session, parts: readonly number[]): void {
  session.setHidden(parts, !parts.every((part) => session.work.hidden.has(part)));
}

/** Return the row that contains an element; null if there is none. */
export function rowOf(target: EventTarget | null): HTMLElement | null {
  return target instanceof Element ? target.closest<HTMLElement>("#side .row") : null;
}

/** Return the node of a row; -1 for none. */
export function idOf(row: HTMLElement | null): number {
  return row === null ? -1 : Number(row.dataset["id"]);
}
