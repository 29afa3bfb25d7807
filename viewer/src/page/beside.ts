/** Shows a second result beside the first, with a shared camera. */

import type { CleaveViewer, LoadDetail } from "../component/element";
import { headers, jobPath, type Job } from "./api";
import { byId } from "./dom";
import type { Modes } from "./session";
import { plural, stem } from "./text";

export class Beside {
  readonly #first: CleaveViewer;
  readonly viewer = document.createElement("cleave-viewer") as CleaveViewer;
  readonly #range = byId<HTMLInputElement>("beside-level");
  readonly #onChange: () => void;
  #job: string | null = null;
  #leading: CleaveViewer | null = null;

  constructor(first: CleaveViewer, onChange: () => void) {
    this.#first = first;
    this.#onChange = onChange;
    this.viewer.toggleAttribute("no-entrance", true);
    first.addEventListener("cleave-view", () => this.#follow(first, this.viewer));
    this.viewer.addEventListener("cleave-view", () => this.#follow(this.viewer, first));
    this.viewer.addEventListener("cleave-load", (event) => this.#loaded((event as CustomEvent<LoadDetail>).detail));
    this.#range.addEventListener("input", () => this.#showLevel(this.#range.valueAsNumber));
    byId("close-beside").addEventListener("click", () => this.close());
  }

  get job(): string | null {
    return this.#job;
  }

  open(job: Job): void {
    this.#job = job.id;
    byId("beside").hidden = false;
    byId("beside-name").textContent = stem(job.input.file_name ?? "mesh");
    byId("beside-about").textContent = differences(job);
    byId("beside-stage").append(this.viewer);
    this.viewer.requestHeaders = headers();
    this.viewer.setAttribute("label", `Second result: ${job.input.file_name ?? "mesh"}`);
    const source = jobPath(job.id, "/model.glb?levels=all");
    this.viewer.setAttribute("original-src", `${source}&keep=all`);
    this.viewer.setAttribute("src", source);
    this.#onChange();
  }

  close(): void {
    if (this.#job === null) return;
    this.#job = null;
    this.viewer.removeAttribute("src");
    this.viewer.remove();
    byId("beside").hidden = true;
    this.#onChange();
  }

  /** Follow the display modes of the first result that concern the whole model. */
  show({ up, look }: Modes): void {
    this.viewer.setAttribute("up", up);
    this.viewer.setAttribute("look", look);
  }

  #loaded({ maxSegments, automaticSegments }: LoadDetail): void {
    this.#range.max = String(maxSegments);
    this.#showLevel(automaticSegments);
    this.viewer.view = this.#first.view;
  }

  #showLevel(segments: number): void {
    this.#range.value = String(segments);
    this.viewer.setAttribute("segments", String(segments));
    const text = plural(segments, "part");
    byId("beside-number").textContent = text;
    this.#range.setAttribute("aria-valuetext", text);
  }

  #follow(leader: CleaveViewer, follower: CleaveViewer): void {
    if (this.#job === null || this.#leading !== null) return;
    this.#leading = leader;
    follower.view = leader.view;
    this.#leading = null;
  }
}

const SHOWN = ["structure", "affinity", "solver", "graph"];

function differences(job: Job): string {
  const values = SHOWN.flatMap((name) => (name in job.parameters ? [String(job.parameters[name])] : []));
  return values.filter((value) => value !== "none").join(" · ");
}
