/** Cuts by hand on top of the levels of a tree: they stay when the level changes. */

import type { Cut, PartTree } from "../component/element";

/** The nodes that a user has split and merged; those that a level does not reach apply again at the levels that do. */
export interface Edits {
  readonly split: ReadonlySet<number>;
  readonly merged: ReadonlySet<number>;
}

export const NO_EDITS: Edits = { split: new Set(), merged: new Set() };

/** Return the cut of a level with the edits that it reaches. */
export function cutWith(tree: PartTree, level: number, { split, merged }: Edits): Cut {
  const cut = new Set(tree.cutAt(level));
  // Parents have smaller numbers than their children.
  for (const id of [...split].sort((a, b) => a - b)) if (isReached(tree, cut, id)) cut.add(id);
  return new Set([...cut].filter((id) => ![...merged].some((above) => tree.contains(above, id))));
}

/** Return the edits that make a cut from a level; earlier edits that the level does not reach are kept. */
export function editsOf(tree: PartTree, level: number, cut: Cut, before: Edits = NO_EDITS): Edits {
  const base = tree.cutAt(level);
  const gone = [...base].filter((id) => !cut.has(id));
  const merged = new Set(gone.filter((id) => isReached(tree, cut, id)));
  for (const id of before.merged) if (!base.has(id) && !cut.has(id)) merged.add(id);
  const split = new Set([...cut].filter((id) => !base.has(id)));
  const isMerged = (id: number) => [...merged].some((above) => tree.contains(above, id));
  for (const id of before.split) if (!isReached(tree, cut, id) && !isMerged(id)) split.add(id);
  return { split, merged };
}

/** Return the level of which a cut differs in the fewest splits: the one with as many. */
export function levelNear(cut: Cut): number {
  return cut.size + 1;
}

/** Hide a part of the new cut if it, its ancestor or all its descendants were hidden in the old one. */
export function carryHidden(tree: PartTree, before: Cut, after: Cut, hidden: ReadonlySet<number>): Set<number> {
  if (hidden.size === 0) return new Set();
  return new Set(
    tree.parts(after).filter((part) => {
      const above = tree.partOf(before, part);
      return above >= 0 ? hidden.has(above) : tree.partsBelow(before, part).every((id) => hidden.has(id));
    }),
  );
}

/** Whether a node is a part of a cut, or split by it. */
function isReached(tree: PartTree, cut: Cut, id: number): boolean {
  const { parent } = tree.node(id);
  return parent < 0 || cut.has(parent);
}
