/** The drawer with the list of jobs: thumbnails, search, deletion. */

import { deleteJob, getBlob, jobPath, listJobs, nameOf, type Job } from "./api";
import type { BatchModel } from "./edit/batch";
import { byId, h, icon, openDialog, toast } from "./dom";
import { explain, problemOf } from "./problems";
import { bytes, plural, when } from "./text";

export type Purpose = "open" | "beside";

const THUMBNAIL = 128; // device pixels

export class JobList {
  readonly #dialog = byId<HTMLDialogElement>("jobs");
  readonly #list = byId("job-list");
  readonly #search = byId<HTMLInputElement>("job-search");
  readonly #onChoose: (job: Job, purpose: Purpose) => void;
  readonly #onDeleted: (id: string) => void;
  readonly #onLabel: (models: readonly BatchModel[]) => void;
  readonly #pictures = new Map<string, string>(); // object URLs by job id
  readonly #seen = new IntersectionObserver((entries) => this.#loadPictures(entries));
  #jobs: Job[] = [];
  #cursor: string | null = null;
  #purpose: Purpose = "open";

  constructor(
    onChoose: (job: Job, purpose: Purpose) => void,
    onDeleted: (id: string) => void,
    onLabel: (models: readonly BatchModel[]) => void,
  ) {
    this.#onLabel = onLabel;
    byId("label-jobs").addEventListener("click", () => this.#label());
    this.#onChoose = onChoose;
    this.#onDeleted = onDeleted;
    this.#search.addEventListener("input", () => this.#filter());
    byId("more-jobs").addEventListener("click", () => void this.#load());
    this.#dialog.addEventListener("close", () => this.#forgetPictures());
  }

  async open(purpose: Purpose): Promise<void> {
    this.#purpose = purpose;
    byId("jobs-title").textContent = purpose === "open" ? "Jobs" : "Compare with";
    this.#search.value = "";
    this.#jobs = [];
    this.#cursor = null;
    this.#list.replaceChildren();
    openDialog(this.#dialog);
    await this.#load();
  }

  async #load(): Promise<void> {
    try {
      const page = await listJobs(this.#cursor);
      const wanted = page.jobs.filter((job) => this.#purpose === "open" || job.status === "succeeded");
      this.#jobs.push(...wanted);
      this.#cursor = page.next_cursor;
      this.#list.append(...wanted.map((job) => this.#row(job)));
    } catch (error) {
      const { title, next } = explain(problemOf(error));
      toast(`${title}. ${next}`);
    }
    byId("more-jobs").hidden = this.#cursor === null;
    this.#filter();
  }

  #row(job: Job): HTMLElement {
    const picture = h("img", { alt: "", width: 64, height: 64, "data-job": job.id });
    if (job.status === "succeeded") this.#seen.observe(picture);
    const open = h(
      "button",
      { type: "button", className: "job", onclick: () => this.#choose(job) },
      picture,
      h("b", {}, nameOf(job)),
      h("span", {}, `${stateOf(job)} · ${when(job.created_at)}`),
    );
    const remove = h("button", { type: "button", className: "quiet icon-button", title: "Delete" }, icon("trash"));
    remove.setAttribute("aria-label", `Delete ${nameOf(job)}`);
    const row = h("li", { className: "job-row", "data-id": job.id, "data-text": `${nameOf(job)} ${job.id}`.toLowerCase() });
    remove.addEventListener("click", () => this.#ask(job, row, remove));
    row.append(open, remove);
    return row;
  }

  /** Label the listed models one after the other. */
  #label(): void {
    this.#dialog.close();
    this.#onLabel(this.#shown().map((job) => ({ job: job.id, name: nameOf(job) })));
  }

  /** Return the finished jobs that match the search. */
  #shown(): Job[] {
    const isShown = (id: string) => this.#list.querySelector<HTMLElement>(`[data-id="${id}"]`)?.hidden === false;
    return this.#jobs.filter((job) => job.status === "succeeded" && isShown(job.id));
  }

  #choose(job: Job): void {
    this.#dialog.close();
    this.#onChoose(job, this.#purpose);
  }

  /** Ask for confirmation before deleting a job. */
  #ask(job: Job, row: HTMLElement, remove: HTMLElement): void {
    const sure = h("button", { type: "button", className: "danger" }, "Delete");
    const keep = h("button", { type: "button", className: "quiet" }, "Keep");
    const question = h("div", { className: "question", role: "group", "aria-label": `Delete ${nameOf(job)}?` }, sure, keep);
    keep.addEventListener("click", () => {
      question.replaceWith(remove);
      remove.focus();
    });
    sure.addEventListener("click", () => void this.#delete(job, row));
    remove.replaceWith(question);
    sure.focus();
  }

  async #delete(job: Job, row: HTMLElement): Promise<void> {
    try {
      await deleteJob(job.id);
    } catch (error) {
      const problem = problemOf(error);
      if (problem.code !== "job_not_found" && problem.code !== "job_deleted") return toast(explain(problem).title);
    }
    this.#jobs = this.#jobs.filter(({ id }) => id !== job.id);
    const next = (row.nextElementSibling ?? row.previousElementSibling)?.querySelector("button") ?? this.#search;
    row.remove();
    next.focus();
    toast(`${nameOf(job)} was deleted.`);
    this.#filter();
    this.#onDeleted(job.id);
  }

  #filter(): void {
    const wanted = this.#search.value.trim().toLowerCase();
    let shown = 0;
    for (const row of this.#list.children) {
      const isShown = (row as HTMLElement).dataset["text"]!.includes(wanted);
      (row as HTMLElement).hidden = !isShown;
      if (isShown) shown++;
    }
    byId("label-jobs").hidden = this.#purpose !== "open" || this.#shown().length < 2;
    byId("no-jobs").hidden = shown > 0;
    byId("no-jobs").textContent = this.#jobs.length === 0 ? "No jobs yet. Drop a mesh to start." : "No job matches.";
  }

  #loadPictures(entries: IntersectionObserverEntry[]): void {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      this.#seen.unobserve(target);
      void this.#loadPicture(target as HTMLImageElement);
    }
  }

  async #loadPicture(image: HTMLImageElement): Promise<void> {
    const id = image.dataset["job"]!;
    try {
      const address = URL.createObjectURL(await getBlob(jobPath(id, `/preview.png?size=${THUMBNAIL}&revision=latest`)));
      this.#pictures.set(id, address);
      image.src = address;
    } catch {
      image.classList.add("is-missing");
    }
  }

  #forgetPictures(): void {
    for (const address of this.#pictures.values()) URL.revokeObjectURL(address);
    this.#pictures.clear();
    this.#seen.disconnect();
  }
}

function stateOf(job: Job): string {
  switch (job.status) {
    case "succeeded":
      return `${job.revision ? "Edited" : plural(job.automatic_segments ?? 1, "part")} · ${plural(job.mesh?.faces ?? 0, "face")}`;
    case "failed":
      return "Failed";
    case "canceled":
      return "Stopped";
    default:
      return `${job.status === "running" ? "Running" : "Waiting"} · ${bytes(job.input.size_bytes)}`;
  }
}
