/** The slider for the number of parts, over a chart of the cut values. */

import type { Job } from "./api";
import { byId } from "./dom";
import type { Session } from "./session";
import { plural } from "./text";
import { endOf, explainNumber } from "./why";

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
  /** Sentences on what limits the result. */
  #notes: readonly string[] = [];
  #isLearned = true;

  constructor(session: () => Session | null) {
    this.#session = session;
    this.#range.addEventListener("input", () => session()?.slide(this.#range.valueAsNumber));
    this.#range.addEventListener("change", () => session()?.endSlide());
    this.#automatic.addEventListener("click", () => {
      const now = session();
      now?.showLevel(now.automaticSegments);
    });
    byId("open-why").addEventListener("click", () => {
      const now = session();
      if (now !== null) explainNumber(now, this.#isLearned);
    });
    byId("discard-edits").addEventListener("click", () => session()?.discardEdits());
    byId("level-less").addEventListener("click", () => session()?.showStep(-1));
    byId("level-more").addEventListener("click", () => session()?.showStep(1));
  }

  /** Draw the chart of a new result. */
  open(session: Session, { notes, parameters }: Job): void {
    this.#notes = notes;
    this.#isLearned = parameters["order"] === "learned" && parameters["affinity"] === "learned";
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
  return clarity(session, value);
}

/** Say how clear the border of the next cut is, in comparison with the cuts that Cleave would make. */
function clarity({ tree, automaticSegments }: Session, next: number | null): string {
  const clear = tree.cutValues.slice(0, automaticSegments - 1).map((value) => value ?? 0);
  if (next !== null && clear.length > 0 && next <= Math.max(...clear)) return "The next cut has a clear border.";
  return "The next cut has a less clear border.";
}
