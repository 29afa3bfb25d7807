/** The card with several models: each becomes a job of its own, which can be opened when it has ended. */

import { cancelJob, getJob, submit, type Job } from "./api";
import type { BatchModel } from "./edit/batch";
import { announce, byId, h } from "./dom";
import { hasEnded } from "./follow";
import { pause } from "./pause";
import { ApiError, explain, problemOf } from "./problems";
import type { Model } from "./sets";
import { shareOf, stageOf, titleOf } from "./stages";
import { bytes, plural } from "./text";

const POLL_MS = 700;
const POLLED = 4; // unfinished jobs that are asked for at a time: the queue runs them in their order
const FULL_PAUSE_MS = 5000; // until the next try if the server has enough jobs

export interface SeveralEvents {
  onOpen(job: Job): void;
  onClose(): void;
  onLabel(models: readonly BatchModel[]): void;
}

type Parameters = Readonly<Record<string, unknown>>;
type End = "succeeded" | "failed" | "stopped";

class Row {
  readonly model: Model;
  readonly parameters: Parameters;
  readonly item: HTMLElement;
  readonly #bar = h("progress", { max: 1, value: 0 });
  readonly #state = h("span", {}, "Waiting");
  readonly #open: HTMLButtonElement;
  #isRefused = false;
  job: Job | null = null;
  end: End | null = null;

  constructor(model: Model, parameters: Parameters, onOpen: (row: Row) => void) {
    this.model = model;
    this.parameters = parameters;
    this.#bar.setAttribute("aria-label", `Progress of ${model.name}`);
    const files = model.files.length > 1 ? `, ${plural(model.files.length, "file")}` : "";
    const open = h("button", { type: "button", disabled: true, onclick: () => onOpen(this) }, "Open");
    open.setAttribute("aria-label", `Open ${model.name}`);
    this.#open = open;
    this.item = h(
      "li",
      { "data-name": model.name },
      h("b", {}, model.name, h("small", {}, ` ${bytes(model.bytes)}${files}`)),
      open,
      this.#bar,
      this.#state,
    );
  }

  show(stage: string, done: number): void {
    this.#bar.value = shareOf(stage, done);
    this.#state.textContent = titleOf(stage);
  }

  /** Show the state of the job. */
  update(job: Job): void {
    this.job = job;
    if (!hasEnded(job)) this.show(stageOf(job), job.progress);
    else if (job.status === "succeeded") this.finish("succeeded", plural(job.automatic_segments ?? 1, "part"));
    else if (job.status === "canceled") this.finish("stopped", "Stopped");
    else this.finish("failed", job.error?.message ?? "The job failed.");
  }

  finish(end: End, text: string): void {
    this.end = end;
    this.#bar.hidden = true;
    this.#state.textContent = text;
    this.#open.disabled = end !== "succeeded";
    this.item.dataset["end"] = end;
    announce(`${this.model.name}: ${text}`);
  }

  /** Finish without a result, for a reason that another try does not change. */
  refuse(text: string): void {
    this.#isRefused = true;
    this.finish("failed", text);
  }

  get canBeTried(): boolean {
    return !this.#isRefused && (this.end === "failed" || this.end === "stopped");
  }

  again(): void {
    this.end = this.job = null;
    this.#bar.hidden = false;
    delete this.item.dataset["end"];
    this.show("upload", 0);
  }
}

export class Several {
  readonly #events: SeveralEvents;
  #rows: Row[] = [];
  #waiting: Row[] = []; // to be uploaded
  #running: AbortController | null = null;

  constructor(events: SeveralEvents) {
    this.#events = events;
    byId("several-stop").addEventListener("click", () => void this.#stop());
    byId("several-again").addEventListener("click", () => this.#again());
    byId("several-close").addEventListener("click", () => this.#close());
    byId("several-label").addEventListener("click", () => this.#label());
  }

  get isOpen(): boolean {
    return this.#rows.length > 0;
  }

  /** Add models to the list, and upload them one after the other; those of more bytes than ``mostBytes`` are refused. */
  add(models: readonly Model[], parameters: Parameters, mostBytes: number): void {
    const rows = models.map((model) => new Row(model, parameters, (row) => this.#events.onOpen(row.job!)));
    this.#rows.push(...rows);
    byId("several-list").append(...rows.map(({ item }) => item));
    for (const row of rows) {
      if (row.model.bytes <= mostBytes) this.#waiting.push(row);
      else row.refuse(`Too large: ${bytes(row.model.bytes)}. This server accepts at most ${bytes(mostBytes)}.`);
    }
    announce(`${plural(models.length, "mesh", "meshes")}, each becomes a job.`);
    this.#begin();
  }

  #begin(): void {
    this.#summarize();
    if (this.#running !== null) return;
    const running = (this.#running = new AbortController());
    void Promise.all([this.#upload(running.signal), this.#poll(running.signal)]).then(() => {
      if (this.#running === running) this.#running = null;
      this.#summarize();
    });
  }

  async #upload(signal: AbortSignal): Promise<void> {
    for (let row = this.#waiting.shift(); row !== undefined && !signal.aborted; row = this.#waiting.shift()) {
      const present = row;
      try {
        present.update(await submit(row.model, row.parameters, signal, (sent) => present.show("upload", sent)));
      } catch (error) {
        if (signal.aborted) return;
        if (error instanceof ApiError && ["too_many_jobs", "queue_full"].includes(error.code)) {
          this.#waiting.unshift(row);
          row.show("queued", 0);
          await pause(FULL_PAUSE_MS);
        } else {
          const { title, detail } = explain(problemOf(error));
          row.finish("failed", `${title}. ${detail}`);
        }
      }
      this.#summarize();
    }
  }

  async #poll(signal: AbortSignal): Promise<void> {
    while (!signal.aborted && this.#rows.some(({ end }) => end === null)) {
      for (const row of this.#rows.filter(({ job, end }) => job !== null && end === null).slice(0, POLLED)) {
        try {
          const job = await getJob(row.job!.id);
          if (!signal.aborted) row.update(job);
        } catch (error) {
          // Without a response, ask again; a job that was deleted has no end.
          if (error instanceof ApiError && error.status < 500) row.finish("failed", explain(problemOf(error)).title);
        }
      }
      this.#summarize();
      await pause(POLL_MS);
    }
  }

  /** Upload again what failed. */
  #again(): void {
    for (const row of this.#rows.filter(({ canBeTried }) => canBeTried)) {
      row.again();
      this.#waiting.push(row);
    }
    this.#begin();
  }

  async #stop(): Promise<void> {
    this.#running?.abort();
    this.#running = null;
    this.#waiting = [];
    const unfinished = this.#rows.filter(({ end }) => end === null);
    for (const row of unfinished) row.finish("stopped", "Stopped");
    this.#summarize();
    for (const { job } of unfinished) if (job !== null) await cancelJob(job.id).catch(() => undefined);
  }

  #label(): void {
    const done = this.#rows.filter(({ end }) => end === "succeeded");
    this.#events.onLabel(done.map(({ job, model }) => ({ job: job!.id, name: model.name })));
  }

  #close(): void {
    this.#rows = [];
    byId("several-list").replaceChildren();
    this.#events.onClose();
  }

  #summarize(): void {
    const count = (wanted: End | null) => this.#rows.filter(({ end }) => end === wanted).length;
    const left = count(null);
    const failed = count("failed") + count("stopped");
    const text = `${count("succeeded")} of ${this.#rows.length} done${failed > 0 ? `, ${failed} without a result` : ""}`;
    byId("several-title").textContent = plural(this.#rows.length, "mesh", "meshes");
    byId("several-summary").textContent = text;
    byId("several-stop").hidden = left === 0;
    byId("several-close").hidden = left > 0;
    byId("several-label").hidden = left > 0 || count("succeeded") < 2;
    byId("several-again").hidden = left > 0 || !this.#rows.some(({ canBeTried }) => canBeTried);
  }
}
