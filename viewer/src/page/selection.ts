/** The panel below the parts: facts about the selected ones, their name, and what can be done with them. */

import { byId } from "./dom";
import type { Session } from "./session";
import { count, figure, plural, share } from "./text";

/** Return the name that all selected parts have; empty if they have several. */
export function sharedName(session: Session): string {
  const names = new Set(session.modes.selected.map((id) => session.nameOf(id)));
  return names.size === 1 ? [...names][0]! : "";
}

/** Show the facts about the selected parts. */
export function describeSelection(session: Session): void {
  const { tree, work, modes } = session;
  const { selected } = modes;
  byId("detail").hidden = selected.length === 0;
  if (selected.length === 0) return;
  const nodes = selected.map((id) => tree.node(id));
  const one = nodes.length === 1 ? nodes[0]! : null;
  const sum = (of: (node: (typeof nodes)[number]) => number) => nodes.reduce((total, node) => total + of(node), 0);
  const name = byId<HTMLInputElement>("part-name");
  name.placeholder = one === null ? `Name all ${selected.length}` : "";
  byId("many-parts").hidden = one !== null;
  byId("many-parts").textContent = `${plural(selected.length, "part")} selected`;
  if (document.activeElement !== name) name.value = sharedName(session);
  byId("detail-area").textContent = share(sum((node) => node.area) / tree.totalArea);
  byId("detail-faces").textContent = count(sum((node) => node.faces));
  byId("detail-made").textContent = one === null || one.parent < 0 ? "–" : figure(tree.node(one.parent).cutValue);
  byId("detail-next").textContent = one === null || one.children.length === 0 ? "–" : figure(one.cutValue);
  byId<HTMLButtonElement>("split").disabled = nodes.every((node) => node.children.length === 0);
  byId<HTMLButtonElement>("merge").disabled = selected.length < 2;
  const isHidden = selected.every((id) => work.hidden.has(id));
  byId("hide").querySelector("span")!.textContent = isHidden ? "Show" : "Hide";
}
