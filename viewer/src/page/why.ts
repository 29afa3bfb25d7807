/** The dialog that says in words what the automatic number and the curve are. */

import { byId, h, openDialog } from "./dom";
import type { Session } from "./session";
import { figure, plural } from "./text";

/** Open the dialog. ``isLearned``: whether the number comes from the learned order of the cuts. */
export function explainNumber(session: Session, isLearned: boolean): void {
  byId("why-title").textContent = `Why ${plural(session.automaticSegments, "part")}?`;
  byId("why-text").replaceChildren(
    ...[chosenNumber(session), isLearned ? LEARNED : BY_VALUE, CURVE, STEPS, endOf(session)].map((text) => h("p", {}, text)),
  );
  openDialog(byId<HTMLDialogElement>("why"));
}

const LEARNED =
  "Cleave has learned from many meshes that people have cut by hand. For every cut it estimates how likely people are to make it, " +
  "and it stops where more cuts would more likely be wrong than right. Another number is not wrong: the slider shows every one.";
const BY_VALUE = "With these parameters Cleave stops before the first cut whose value is above a fixed one. The slider shows every other number.";
const CURVE =
  "The curve above the slider shows the value of each cut, from the first on the left. The value is small if a short border parts two " +
  "large pieces, as at a waist or along a crease, and large if nothing in the shape suggests a border. Where the curve rises steeply, the " +
  "clear borders end. The dashed line marks the automatic number; the coloured area is what is cut now.";
const STEPS =
  "The buttons beside the number go to the next number at which equal parts, such as the legs of a table, are cut off together.";

function chosenNumber({ tree, automaticSegments }: Session): string {
  const values = tree.cutValues;
  const made = values.slice(0, automaticSegments - 1).map((value) => value ?? 0);
  const next = values[automaticSegments - 1] ?? undefined;
  if (made.length === 0) return next === undefined ? "No cut of this mesh is sensible." : `No cut is clear: the first one would have the value ${figure(next)}.`;
  const soFar = `The cuts into ${plural(automaticSegments, "part")} have values of at most ${figure(Math.max(...made))}`;
  return next === undefined ? `${soFar}, and no further one is sensible.` : `${soFar}; the next one would have ${figure(next)}.`;
}

/** Return where the hierarchy ends and why. */
export function endOf({ limitReached, tree }: Session): string {
  const most = plural(tree.maxSegments, "part");
  if (limitReached === null) return `The hierarchy ends at ${most}.`;
  return limitReached
    ? `The hierarchy ends at the limit of ${most}: raise "Most parts" in the parameters for more.`
    : `The hierarchy ends at ${most}: no sensible cut is left.`;
}
