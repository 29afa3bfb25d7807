/** Shows a second result beside the first: one camera, matched colours, and what differs. */

import type { CleaveViewer, LoadDetail } from "../component/element";
import { headers, jobPath, nameOf, request, type Job } from "./api";
import { Overlap, sideOf, type Comparison } from "./compare";
import { byId } from "./dom";
import type { Result, Session } from "./session";
import { figure, plural, share, stem } from "./text";
import { applyModes } from "./tools";

export class Beside {
  readonly #first: CleaveViewer;
  readonly viewer = document.createElement("cleave-viewer") as CleaveViewer;
  readonly #range = byId<HTMLInputElement>("beside-level");
  readonly #shown: () => Result | null;
  readonly #onChange: () => void;
  #job: Job | null = null;
  #leading: CleaveViewer | null = null;
  #overlap: Overlap | null = null;
  #comparison: Comparison | null = null;
  #compared = "";
  #isDifferenceShown = false;

  /** ``onChange`` is called when another job is shown, or none. */
  constructor(first: CleaveViewer, shown: () => Result | null, onChange: () => void) {
    this.#first = first;
    this.#shown = shown;
    this.#onChange = onChange;
    this.viewer.toggleAttribute("no-entrance", true);
    first.addEventListener("cleave-view", () => this.#follow(first, this.viewer));
    this.viewer.addEventListener("cleave-view", () => this.#follow(this.viewer, first));
    this.viewer.addEventListener("cleave-load", (event) => this.#loaded((event as CustomEvent<LoadDetail>).detail));
    this.viewer.addEventListener("cleave-select", (event) => this.#selected(event as CustomEvent<{ parts: number[] }>));
    this.#range.addEventListener("input", () => this.#showLevel(this.#range.valueAsNumber));
    byId("beside-difference").addEventListener("click", () => this.#showDifference(!this.#isDifferenceShown));
    byId("close-beside").addEventListener("click", () => this.close());
  }

  /** The id of the second job; null if none is shown. */
  get job(): string | null {
    return this.#job?.id ?? null;
  }

  open(job: Job): void {
    this.#forget();
    this.#job = job;
    byId("beside").hidden = false;
    byId("beside-name").textContent = stem(nameOf(job));
    byId("beside-about").textContent = parametersOf(job);
    byId("beside-stage").append(this.viewer);
    this.viewer.requestHeaders = headers();
    this.viewer.setAttribute("label", `Second result: ${nameOf(job)}`);
    const source = jobPath(job.id, "/model.glb?levels=all");
    this.viewer.setAttribute("original-src", `${source}&keep=all`);
    this.viewer.setAttribute("src", source);
    this.#onChange();
  }

  close(): void {
    if (this.#job === null) return;
    this.#job = null;
    this.#forget();
    this.viewer.removeAttribute("src");
    this.viewer.remove();
    byId("beside").hidden = true;
    this.#onChange();
  }

  /** Follow the modes, the selection and the hidden parts of the first result, and compare the parts again. */
  update(): void {
    const first = this.#shown();
    if (this.#job === null || first === null || this.viewer.tree === null) return;
    const { modes, work } = first.session;
    applyModes(this.viewer, modes);
    this.#compare(first.session);
    if (this.#comparison === null) return;
    const { toA } = this.#comparison;
    const parts = this.viewer.parts;
    this.viewer.selected = parts.filter((part) => modes.selected.includes(toA.get(part)!));
    this.viewer.hiddenParts = new Set(parts.filter((part) => work.hidden.has(toA.get(part)!)));
  }

  #forget(): void {
    this.#showDifference(false);
    this.#overlap = this.#comparison = null;
    this.#compared = "";
    byId("beside-figures").textContent = "";
    byId("beside-difference").hidden = true;
  }

  #loaded({ maxSegments, automaticSegments }: LoadDetail): void {
    this.#range.max = String(maxSegments);
    this.viewer.view = this.#first.view;
    this.#showLevel(automaticSegments);
    void this.#prepare();
  }

  /** Load the labels of both jobs, if they have segmented the same file. */
  async #prepare(): Promise<void> {
    const [second, first] = [this.#job, this.#shown()];
    if (second === null || first === null) return;
    if (first.job.input.sha256 !== second.input.sha256) {
      byId("beside-figures").textContent = "Another file: the parts are not compared.";
      return;
    }
    const sides = [this.#first, this.viewer].map(({ tree, faces }) => ({ tree, faces }));
    const labels = await Promise.all([first.job, second].map(finestLabels)).catch(() => null);
    const isStale = this.#job !== second || sides.some(({ tree, faces }) => tree === null || faces === null);
    if (labels === null || isStale) return;
    const [a, b] = sides.map(({ tree, faces }, k) => sideOf(tree!, faces!, labels[k]!));
    this.#overlap = new Overlap(a!, b!);
    byId("beside-difference").hidden = false;
    this.update();
  }

  #compare({ work: { cut } }: Session): void {
    if (this.#overlap === null) return;
    const compared = `${[...cut].join()}|${[...this.viewer.cut].join()}|${this.#isDifferenceShown}`;
    if (compared === this.#compared) return;
    this.#compared = compared;
    const comparison = (this.#comparison = this.#overlap.compare(cut, this.viewer.cut));
    this.viewer.colors = new Map([...comparison.toA].map(([b, a]) => [b, this.#first.shadeOf(a)]));
    byId("beside-figures").textContent = `${share(comparison.share)} of the area differs · 1 − Rand index ${figure(comparison.rand)}`;
    const faces = this.#isDifferenceShown ? this.#overlap.differing(cut, this.viewer.cut, comparison) : null;
    this.#first.marked = faces?.a ?? null;
    this.viewer.marked = faces?.b ?? null;
  }

  #showDifference(isShown: boolean): void {
    this.#isDifferenceShown = isShown;
    byId("beside-difference").setAttribute("aria-pressed", String(isShown));
    if (!isShown) this.#first.marked = this.viewer.marked = null;
    this.update();
  }

  /** Select the parts of the first result that correspond to those that were selected in the second. */
  #selected(event: CustomEvent<{ parts: number[] }>): void {
    const { session } = this.#shown() ?? {};
    if (this.#comparison === null || session === undefined) return;
    event.preventDefault();
    const { toA } = this.#comparison;
    session.setModes({ selected: [...new Set(event.detail.parts.map((part) => toA.get(part)!))] });
  }

  #showLevel(segments: number): void {
    this.#range.value = String(segments);
    this.viewer.setAttribute("segments", String(segments));
    const text = plural(segments, "part");
    byId("beside-number").textContent = text;
    this.#range.setAttribute("aria-valuetext", text);
    this.update();
  }

  #follow(leader: CleaveViewer, follower: CleaveViewer): void {
    if (this.#job === null || this.#leading !== null) return;
    this.#leading = leader;
    follower.view = leader.view;
    this.#leading = null;
  }
}

/** Return the labels of the finest level of a job, in the order of its file. */
async function finestLabels({ id, max_segments }: Job): Promise<Int32Array> {
  const answer = await request(jobPath(id, `/labels?format=raw&segments=${max_segments}`));
  return new Int32Array(await answer.arrayBuffer());
}

const SHOWN = ["structure", "affinity", "solver", "graph"];

function parametersOf(job: Job): string {
  const values = SHOWN.flatMap((name) => (name in job.parameters ? [String(job.parameters[name])] : []));
  return values.filter((value) => value !== "none").join(" · ");
}
