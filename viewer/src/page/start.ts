/** The start page: choosing a file or a sample, the upload, and the progress of the job. */

import { apiKey, cancelJob, getBlob, getFormats, submit, type Job } from "./api";
import { announce, byId, h, toast } from "./dom";
import { MOST_FILES, type Found } from "./files";
import { follow, hasEnded } from "./follow";
import { Intake } from "./intake";
import lists from "./lists.json";
import { ApiError, explain, problemOf, type Problem, type Remedy } from "./problems";
import { modelOfFile, sorted, type Model } from "./sets";
import { Several } from "./several";
import { openStages, showProgress, showStage } from "./stages";
import { bytes, plural } from "./text";

type Parameters = Readonly<Record<string, unknown>>;

export interface StartEvents {
  onFinished(job: Job, model: Model | null): void;
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

const MOST_NAMED = 5; // files in a message
const FORMATS = lists.inputFormats.map(({ title }) => title).join(", ");

export class Start {
  readonly #events: StartEvents;
  readonly #intake = new Intake({
    onFiles: (found) => void this.#take(found),
    onTooMany: () => this.fail({ code: "too_many_files", detail: `At most ${plural(MOST_FILES, "file")} are taken at a time.` }),
  });
  readonly #several = new Several({
    onOpen: (job, model) => this.#events.onFinished(job, model),
    onClose: () => this.#events.onLeave(),
  });
  #running: AbortController | null = null;
  #job: Job | null = null;
  #last: { model: Model; parameters: Parameters } | null = null;
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

  /** Upload a model and follow its job. */
  async send(model: Model, parameters: Parameters): Promise<void> {
    this.#last = { model, parameters };
    if (model.bytes > this.#mostBytes) {
      const with_ = model.files.length > 1 ? ` with its ${plural(model.files.length - 1, "file")}` : "";
      const detail = `${model.name}${with_} has ${bytes(model.bytes)}; this server accepts at most ${bytes(this.#mostBytes)}.`;
      return this.fail({ code: "too_large", detail });
    }
    await this.#run(model.name, model, (signal) => {
      showStage("upload", 0);
      return submit(model, parameters, signal, (sent) => showStage("upload", sent));
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

  /** Sort files: one model is sent at once, several become a list; other files are named and left out. */
  async #take(found: readonly Found[]): Promise<void> {
    try {
      const { models, leftOut } = await sorted(found);
      if (models.length === 0) return this.fail({ code: "no_mesh", detail: named(leftOut) });
      this.#send(models, leftOut.length === 0 ? "" : `Left out, because no mesh refers to them: ${named(leftOut)}`);
    } catch {
      this.fail({ code: "unreadable", detail: "The browser could not read the files." });
    }
  }

  #send(models: readonly Model[], note: string): void {
    const { parameters } = this;
    this.parameters = {};
    if (models.length === 1) void this.send(models[0]!, parameters);
    else {
      this.#running?.abort();
      this.show("several");
      this.#several.add(models, parameters, this.#mostBytes);
    }
    for (const id of ["progress-note", "several-note"]) byId(id).textContent = note;
    if (note !== "") toast(note);
  }

  async #run(name: string, model: Model | null, begin: (signal: AbortSignal) => Promise<Job>): Promise<void> {
    this.#running?.abort();
    const running = (this.#running = new AbortController());
    openStages(name);
    this.show("progress");
    try {
      this.#job = await begin(running.signal);
      const job = hasEnded(this.#job)
        ? this.#job
        : await follow(this.#job.id, { onJob: showProgress, onConnection: connection }, running.signal);
      if (!running.signal.aborted) this.#ended(job, model);
    } catch (error) {
      if (!running.signal.aborted) this.fail(problemOf(error));
    } finally {
      connection(true);
    }
  }

  #ended(job: Job, model: Model | null): void {
    if (job.status === "succeeded") {
      showStage("show", 1);
      this.#events.onFinished(job, model);
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
    else if (remedy === "key") this.#askForKey();
    else if (remedy === "retry" && this.#last !== null) void this.send(this.#last.model, this.#last.parameters);
    else this.#events.onRemedy(remedy);
  }

  #askForKey(): void {
    const dialog = byId<HTMLDialogElement>("key-dialog");
    dialog.showModal();
    byId("key-form").onsubmit = () => {
      apiKey.set(byId<HTMLInputElement>("key").value.trim());
      if (this.#last !== null) void this.send(this.#last.model, this.#last.parameters);
      else location.reload();
    };
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
      this.#send([modelOfFile(new File([blob], `${name}.ply`))], "");
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
