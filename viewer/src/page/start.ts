/** The start page: choosing a file or a sample, the upload, and the progress of the job. */

import { apiKey, cancelJob, getBlob, getFormats, submit, type Job } from "./api";
import { announce, byId, h, icon } from "./dom";
import { follow, hasEnded } from "./follow";
import lists from "./lists.json";
import { ApiError, explain, problemOf, type Problem, type Remedy } from "./problems";
import { bytes } from "./text";

type Parameters = Readonly<Record<string, unknown>>;

export interface StartEvents {
  onFinished(job: Job, file: File | null): void;
  onRemedy(remedy: Remedy): void;
  /** Called if the user stops a job or goes back from an error. */
  onLeave(): void;
}

const SAMPLES: readonly [name: string, title: string][] = [
  ["jack", "Jack"],
  ["pawn", "Pawn"],
  ["dumbbell", "Dumbbell"],
  ["stool", "Stool"],
];

/** Titles of the stages of a job, in order. */
const STAGES: readonly [stage: string, title: string][] = [
  ["upload", "Sending the mesh"],
  ["queued", "Waiting for a worker"],
  ...lists.stages.map(({ name, title }): [string, string] => [name, title]),
  ["show", "Drawing"],
];
const FORMATS = lists.inputFormats.map(({ title }) => title).join(", ");

export class Start {
  readonly #events: StartEvents;
  readonly #input = byId<HTMLInputElement>("file");
  #running: AbortController | null = null;
  #job: Job | null = null;
  #last: { file: File; parameters: Parameters } | null = null;
  #mostBytes = Infinity;
  /** Parameters for the next file that is chosen. */
  parameters: Parameters = {};

  constructor(events: StartEvents) {
    this.#events = events;
    this.#input.addEventListener("change", () => {
      const file = this.#input.files?.[0];
      this.#input.value = "";
      if (file !== undefined) this.#take(file);
    });
    for (const button of document.querySelectorAll(".choose")) button.addEventListener("click", () => this.choose());
    byId("stop").addEventListener("click", () => void this.#stop());
    byId("remedy").addEventListener("click", () => this.#remedy());
    byId("back").addEventListener("click", () => this.#events.onLeave());
    this.#listenToDrops();
    this.#fillSamples();
    this.#input.accept = [...lists.inputFormats.flatMap(({ extensions }) => extensions), ".gz", ".zip"].join(",");
    byId("formats").textContent = FORMATS;
    void this.#loadLimits();
  }

  choose(): void {
    this.#input.click();
  }

  /** Show one of the cards of the start page, or none. */
  show(what: "start" | "progress" | "problem" | "none"): void {
    byId("welcome").hidden = what === "none";
    for (const id of ["start", "progress", "problem"]) byId(id).hidden = id !== what;
  }

  /** Upload a file and follow its job. */
  async send(file: File, parameters: Parameters): Promise<void> {
    this.#last = { file, parameters };
    if (file.size > this.#mostBytes) {
      const detail = `${file.name} has ${bytes(file.size)}; this server accepts at most ${bytes(this.#mostBytes)}.`;
      return this.fail({ code: "too_large", detail });
    }
    await this.#run(file.name, file, (signal) => {
      this.#stage("upload", 0);
      return submit(file, parameters, signal, (sent) => this.#stage("upload", sent));
    });
  }

  /** Follow a job that was submitted earlier. */
  async resume(job: Job): Promise<void> {
    this.#last = null;
    await this.#run(job.input.file_name ?? "mesh", null, () => Promise.resolve(job));
  }

  fail(problem: Problem): void {
    const { title, detail, next, remedy } = explain(problem);
    byId("problem-title").textContent = title;
    byId("problem-detail").textContent = detail;
    byId("problem-next").textContent = next;
    const button = byId<HTMLButtonElement>("remedy");
    button.dataset["remedy"] = remedy;
    button.textContent = REMEDIES[remedy];
    byId("problem").dataset["code"] = problem.code;
    this.show("problem");
    announce(`${title}. ${detail} ${next}`);
    button.focus();
  }

  #take(file: File): void {
    const { parameters } = this;
    this.parameters = {};
    void this.send(file, parameters);
  }

  async #run(name: string, file: File | null, begin: (signal: AbortSignal) => Promise<Job>): Promise<void> {
    this.#running?.abort();
    const running = (this.#running = new AbortController());
    byId("progress-name").textContent = name;
    this.#fillStages();
    this.show("progress");
    try {
      this.#job = await begin(running.signal);
      const job = hasEnded(this.#job)
        ? this.#job
        : await follow(this.#job.id, { onJob: (job) => this.#showProgress(job), onConnection: connection }, running.signal);
      if (!running.signal.aborted) this.#ended(job, file);
    } catch (error) {
      if (!running.signal.aborted) this.fail(problemOf(error));
    } finally {
      connection(true);
    }
  }

  #ended(job: Job, file: File | null): void {
    if (job.status === "succeeded") {
      this.#stage("show", 1);
      this.#events.onFinished(job, file);
    } else {
      this.fail({ code: job.error?.code ?? job.status, detail: job.error?.message ?? "The job was stopped." });
    }
  }

  #showProgress(job: Job): void {
    const waiting = job.status === "queued";
    this.#stage(waiting ? "queued" : (job.stage ?? lists.stages[0]!.name), job.progress);
    const place = waiting && (job.queue_position ?? 0) > 1 ? `, ${job.queue_position! - 1} ahead of it` : "";
    byId("stages").querySelector("[data-stage=queued] span")!.textContent = `Waiting for a worker${place}`;
  }

  /** Mark the current stage; ``done`` is the completed fraction of the upload or of the job, 0..1. */
  #stage(stage: string, done: number): void {
    const at = Math.max(STAGES.findIndex(([name]) => name === stage), 0);
    const bar = byId<HTMLProgressElement>("progress-bar");
    // The upload takes the first third of the bar: upload and job both take seconds.
    bar.value = stage === "upload" ? done / 3 : 1 / 3 + (2 / 3) * done;
    byId("progress-share").textContent = `${Math.round(100 * bar.value)} %`;
    [...byId("stages").children].forEach((item, i) => {
      const state = i < at ? "done" : i === at ? "now" : "later";
      if (item.getAttribute("data-state") === state) return;
      item.setAttribute("data-state", state);
      if (state === "now") item.setAttribute("aria-current", "step");
      else item.removeAttribute("aria-current");
      if (state === "now") announce(STAGES[i]![1]);
    });
  }

  #fillStages(): void {
    byId("stages").replaceChildren(
      ...STAGES.map(([stage, title]) =>
        h("li", { "data-stage": stage, "data-state": "later" }, icon("check"), h("span", {}, title)),
      ),
    );
  }

  async #stop(): Promise<void> {
    const job = this.#job;
    this.#running?.abort();
    this.#job = null;
    this.#events.onLeave();
    if (job !== null && !hasEnded(job)) await cancelJob(job.id).catch(() => undefined);
  }

  #remedy(): void {
    const remedy = byId<HTMLButtonElement>("remedy").dataset["remedy"] as Remedy;
    if (remedy === "choose") this.choose();
    else if (remedy === "key") this.#askForKey();
    else if (remedy === "retry" && this.#last !== null) void this.send(this.#last.file, this.#last.parameters);
    else this.#events.onRemedy(remedy);
  }

  #askForKey(): void {
    const dialog = byId<HTMLDialogElement>("key-dialog");
    dialog.showModal();
    byId("key-form").onsubmit = () => {
      apiKey.set(byId<HTMLInputElement>("key").value.trim());
      if (this.#last !== null) void this.send(this.#last.file, this.#last.parameters);
      else location.reload();
    };
  }

  #listenToDrops(): void {
    let depth = 0;
    const mark = (by: number) => {
      depth = Math.max(depth + by, 0);
      document.body.classList.toggle("is-dropping", depth > 0);
    };
    addEventListener("dragenter", () => mark(1));
    addEventListener("dragleave", () => mark(-1));
    addEventListener("dragover", (event) => event.preventDefault());
    addEventListener("drop", (event) => {
      event.preventDefault();
      mark(-depth);
      const file = event.dataTransfer?.files[0];
      if (file !== undefined) this.#take(file);
    });
  }

  #fillSamples(): void {
    byId("samples").replaceChildren(
      ...SAMPLES.map(([name, title]) =>
        h(
          "li",
          {},
          h(
            "button",
            { type: "button", className: "sample", "data-sample": name, onclick: () => void this.#sendSample(name) },
            h("img", { src: `viewer/sample-${name}.png`, alt: "", width: 112, height: 112 }),
            h("span", {}, title),
          ),
        ),
      ),
    );
  }

  async #sendSample(name: string): Promise<void> {
    try {
      const blob = await getBlob(`samples/${name}.ply`);
      this.#take(new File([blob], `${name}.ply`));
    } catch (error) {
      this.fail(problemOf(error));
    }
  }

  async #loadLimits(): Promise<void> {
    try {
      const { max_upload_bytes } = await getFormats();
      this.#mostBytes = max_upload_bytes;
      byId("formats").textContent = `${FORMATS}, up to ${bytes(max_upload_bytes)}`;
    } catch (error) {
      if (error instanceof ApiError && error.status === 401) this.fail(problemOf(error));
    }
  }
}

const REMEDIES: Record<Remedy, string> = {
  choose: "Choose another file",
  retry: "Try again",
  parameters: "Change the parameters",
  key: "Enter a key",
  jobs: "Open the list of jobs",
};

function connection(isThere: boolean): void {
  const note = byId("offline");
  if (note.hidden === isThere) return;
  note.hidden = isThere;
  announce(isThere ? "The server is responding again." : "The server is not responding. Retrying.");
}
