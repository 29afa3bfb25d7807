/** The start page: choosing a file or a sample, the upload, and the progress of the job. */

import { cancelJob, checkKey, getBlob, getFormats, nameOf, rerun, submit, type Job } from "./api";
import { announce, byId, h, toast } from "./dom";
import { MOST_FILES, type Found } from "./files";
import { follow, hasEnded } from "./follow";
import { Intake } from "./intake";
import { askForKey, describeKey } from "./keys";
import lists from "./lists.json";
import { explain, problemOf, type Problem, type Remedy } from "./problems";
import { modelOfFile, sorted, type Model } from "./sets";
import { Several } from "./several";
import type { BatchModel } from "./edit/batch";
import { explainWaiting, openStages, showProgress, showStage } from "./stages";
import { bytes, plural } from "./text";

type Parameters = Readonly<Record<string, unknown>>;

/** What is to be done with the result of a job. */
export interface Purpose {
  /** The number of parts to show; null for the automatic number. */
  readonly segments: number | null;
  /** Whether it is shown beside the present result. */
  readonly isBeside: boolean;
}

const TO_SHOW: Purpose = { segments: null, isBeside: false };

export interface StartEvents {
  /** Called when the server has accepted a job. */
  onAccepted(job: Job, purpose: Purpose): void;
  onFinished(job: Job, purpose: Purpose): void;
  onRemedy(remedy: Remedy): void;
  /** Called if the user stops a job or goes back from an error. */
  onLeave(): void;
  onLabel(models: readonly BatchModel[]): void;
}

const SAMPLES: readonly [name: string, title: string][] = [
  ["jack", "Jack"],
  ["pawn", "Pawn"],
  ["dumbbell", "Dumbbell"],
  ["stool", "Stool"],
];

const MOST_NAMED = 5; // files in a message
const FORMATS = lists.inputFormats.map(({ title }) => title).join(", ");

export class Start {
  readonly #events: StartEvents;
  readonly #intake = new Intake({
    onFiles: (found) => void this.#take(found),
    onTooMany: () => this.fail({ code: "too_many_files", detail: `At most ${plural(MOST_FILES, "file")} are taken at a time.` }),
  });
  readonly #several = new Several({
    onOpen: (job) => this.#events.onFinished(job, TO_SHOW),
    onClose: () => this.#events.onLeave(),
    onLabel: (models) => this.#events.onLabel(models),
  });
  #running: AbortController | null = null;
  #job: Job | null = null;
  #retry: (() => void) | null = null;
  #mostBytes = Infinity;
  /** Parameters for the next files that are chosen. */
  parameters: Parameters = {};

  constructor(events: StartEvents) {
    this.#events = events;
    byId("stop").addEventListener("click", () => void this.#stop());
    byId("remedy").addEventListener("click", () => this.#remedy());
    byId("back").addEventListener("click", () => this.#events.onLeave());
    this.#fillSamples();
    byId("formats").textContent = FORMATS;
    void this.#loadLimits();
  }

  choose(): void {
    this.#intake.choose();
  }

  /** Show one of the cards of the start page, or none; the list of several models takes the place of the start. */
  show(what: "start" | "progress" | "several" | "problem" | "none"): void {
    const shown = what === "start" && this.#several.isOpen ? "several" : what;
    byId("welcome").hidden = shown === "none";
    for (const id of ["start", "progress", "several", "problem"]) byId(id).hidden = id !== shown;
  }

  /** Run a job again with other parameters. */
  async rerun(job: Job, parameters: Parameters, purpose: Purpose): Promise<void> {
    this.#retry = () => void this.rerun(job, parameters, purpose);
    await this.#run(nameOf(job), purpose, () => rerun(job.id, parameters));
  }

  /** Follow a job that was submitted earlier. */
  async resume(job: Job, purpose = TO_SHOW): Promise<void> {
    this.#retry = () => void this.rerun(job, job.parameters, purpose);
    await this.#run(nameOf(job), purpose, () => Promise.resolve(job));
  }

  /** Leave the job alone that the progress card shows; the server goes on with it. */
  rest(): void {
    this.#running?.abort();
    this.#job = null;
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

  /** Sort files: one model is sent at once, several become a list; other files are named and left out. */
  async #take(found: readonly Found[]): Promise<void> {
    try {
      const { models, leftOut } = await sorted(found);
      if (models.length === 0) return this.fail({ code: "no_mesh", detail: named(leftOut) });
      await this.#send(models, leftOut.length === 0 ? "" : `Left out, because no mesh refers to them: ${named(leftOut)}`);
    } catch {
      this.fail({ code: "unreadable", detail: "The browser could not read the files." });
    }
  }

  /** Check the API key, then send one model, or show the list of several. */
  async #send(models: readonly Model[], note: string): Promise<void> {
    this.#retry = () => void this.#send(models, note);
    try {
      await checkKey();
    } catch (error) {
      return this.fail(problemOf(error));
    }
    const { parameters } = this;
    this.parameters = {};
    if (models.length === 1) void this.#sendOne(models[0]!, parameters);
    else {
      this.#running?.abort();
      this.show("several");
      this.#several.add(models, parameters, this.#mostBytes);
    }
    for (const id of ["progress-note", "several-note"]) byId(id).textContent = note;
    if (note !== "") toast(note);
  }

  async #sendOne(model: Model, parameters: Parameters): Promise<void> {
    this.#retry = () => void this.#sendOne(model, parameters);
    if (model.bytes > this.#mostBytes) {
      const with_ = model.files.length > 1 ? ` with its ${plural(model.files.length - 1, "file")}` : "";
      const detail = `${model.name}${with_} has ${bytes(model.bytes)}; this server accepts at most ${bytes(this.#mostBytes)}.`;
      return this.fail({ code: "too_large", detail });
    }
    await this.#run(model.name, TO_SHOW, (signal) => {
      showStage("upload", 0);
      return submit(model, parameters, signal, (sent) => showStage("upload", sent));
    });
  }

  async #run(name: string, purpose: Purpose, begin: (signal: AbortSignal) => Promise<Job>): Promise<void> {
    this.#running?.abort();
    const running = (this.#running = new AbortController());
    openStages(name);
    this.show("progress");
    void explainWaiting(running.signal);
    try {
      this.#job = await begin(running.signal);
      if (running.signal.aborted) return;
      this.#events.onAccepted(this.#job, purpose);
      if (!hasEnded(this.#job)) showProgress(this.#job);
      const job = hasEnded(this.#job)
        ? this.#job
        : await follow(this.#job.id, { onJob: showProgress, onConnection: connection }, running.signal);
      if (!running.signal.aborted) this.#ended(job, purpose);
    } catch (error) {
      if (!running.signal.aborted) this.fail(problemOf(error));
    } finally {
      running.abort();
      connection(true);
    }
  }

  #ended(job: Job, purpose: Purpose): void {
    if (job.status === "succeeded") {
      showStage("show", 1);
      this.#events.onFinished(job, purpose);
    } else {
      this.fail({ code: job.error?.code ?? job.status, detail: job.error?.message ?? "The job was stopped." });
    }
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
    else if (remedy === "key") askForKey(this.#retry ?? (() => location.reload()));
    else if (remedy === "retry" && this.#retry !== null) this.#retry();
    else this.#events.onRemedy(remedy);
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
      await this.#send([modelOfFile(new File([blob], `${name}.ply`))], "");
    } catch (error) {
      this.fail(problemOf(error));
    }
  }

  async #loadLimits(): Promise<void> {
    try {
      const { max_upload_bytes } = await getFormats();
      this.#mostBytes = max_upload_bytes;
      byId("formats").textContent = `${FORMATS}, up to ${bytes(max_upload_bytes)}`;
      await describeKey();
    } catch {
      // The server is away; what is chosen now explains that.
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

function named(paths: readonly string[]): string {
  const shown = paths.slice(0, MOST_NAMED).join(", ");
  return paths.length > MOST_NAMED ? `${shown} and ${paths.length - MOST_NAMED} more.` : shown === "" ? "There are no files." : `${shown}.`;
}

function connection(isThere: boolean): void {
  const note = byId("offline");
  if (note.hidden === isThere) return;
  note.hidden = isThere;
  announce(isThere ? "The server is responding again." : "The server is not responding. Retrying.");
}
