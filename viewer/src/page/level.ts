/** The slider for the number of parts, over a chart of the cut values. */

import { byId } from "./dom";
import type { Session } from "./session";
import { figure, plural } from "./text";

const HEIGHT = 40;
const HEADROOM = 3; // pixels above the highest value

export class LevelSlider {
  readonly #range = byId<HTMLInputElement>("level");
  readonly #number = byId<HTMLOutputElement>("level-number");
  readonly #unit = byId("level-unit");
  readonly #note = byId("level-note");
  readonly #automatic = byId<HTMLButtonElement>("level-automatic");
  readonly #chart = byId<SVGSVGElement>("level-chart");
  readonly #session: () => Session | null;
  #notes: readonly string[] = [];

  constructor(session: () => Session | null) {
    this.#session = session;
    this.#range.addEventListener("input", () => session()?.slide(this.#range.valueAsNumber));
    this.#range.addEventListener("change", () => session()?.endSlide());
    this.#automatic.addEventListener("click", () => {
      const now = session();
      now?.showLevel(now.automaticSegments);
    });
    byId("discard-edits").addEventListener("click", () => session()?.discardEdits());
    byId("level-less").addEventListener("click", () => session()?.showStep(-1));
    byId("level-more").addEventListener("click", () => session()?.showStep(1));
  }

  /** Draw the chart of a new result; ``notes`` are sentences on what limits it. */
  open(session: Session, notes: readonly string[]): void {
    this.#notes = notes;
    const values = session.tree.cutValues;
    const most = session.tree.maxSegments;
    this.#range.max = String(most);
    this.#range.disabled = most === 1;
    this.#chart.setAttribute("viewBox", `0 0 ${Math.max(most - 1, 1)} ${HEIGHT}`);
    const highest = Math.max(...values.map((value) => value ?? 0), Number.MIN_VALUE);
    // Square roots: cuts between parts have much smaller values than the arbitrary cuts at the end.
    const heights = values.map((value) => HEIGHT - (HEIGHT - HEADROOM) * Math.sqrt((value ?? highest) / highest));
    const curve = heights.map((height, i) => `${i === 0 ? "M" : "L"}${i + 1} ${height}`).join("");
    const area = values.length === 0 ? "" : `M0 ${HEIGHT}L1 ${heights[0]}${curve.replace("M", "L")}V${HEIGHT}Z`;
    for (const path of this.#chart.querySelectorAll(".area")) path.setAttribute("d", area);
    this.#chart.querySelector(".curve")!.setAttribute("d", curve);
    const mark = this.#chart.querySelector(".mark")!;
    mark.setAttribute("d", `M${session.automaticSegments - 1} 0V${HEIGHT}`);
    this.#automatic.querySelector("b")!.textContent = String(session.automaticSegments);
    byId("level-end").textContent = endOf(session);
    this.update();
  }

  update(): void {
    const session = this.#session();
    if (session === null) return;
    const { level } = session.work;
    const parts = session.parts.length;
    this.#range.value = String(level);
    this.#number.value = String(parts);
    this.#unit.textContent = parts === 1 ? "part" : "parts";
    this.#range.setAttribute("aria-valuetext", `${plural(parts, "part")}${session.isEdited ? ", with cuts by hand" : ""}`);
    this.#automatic.setAttribute("aria-pressed", String(level === session.automaticSegments && !session.isEdited));
    const state = session.isEdited ? "Cut by hand: these cuts stay if you move the slider." : nextCut(session, level);
    this.#note.textContent = [state, ...this.#notes].join(" ");
    byId("discard-edits").hidden = !session.isEdited;
    this.#chart.querySelector("#level-clip rect")!.setAttribute("width", String(level - 1));
  }
}

function nextCut(session: Session, segments: number): string {
  const value = session.tree.cutValues[segments - 1];
  if (value === undefined) return "This is the finest level.";
  const { tree } = session;
  if (!tree.stepEnds.includes(segments))
    return `Some of a group of equal parts are cut off: all of them are at ${plural(tree.stepEndBeside(segments, 1), "part")}.`;
  return `Value of the next cut: ${figure(value)}. Low values are clear borders.`;
}

/** Return where the hierarchy ends and why. */
function endOf({ limitReached, tree }: Session): string {
  const most = plural(tree.maxSegments, "part");
  if (limitReached === null) return `The hierarchy ends at ${most}.`;
  return limitReached
    ? `The hierarchy ends at the limit of ${most}: raise max_segments for more.`
    : `The hierarchy ends at ${most}: no sensible cut is left.`;
}
