/** The card with the progress of one job. */

import { getReadiness, type Job } from "./api";
import { announce, byId, h, icon } from "./dom";
import lists from "./lists.json";
import { pause } from "./pause";
import { plural } from "./text";

const UPLOAD = 0.1; // share of the bar; set by hand: most uploads are much shorter than their jobs
const MINUTES_FROM_S = 100; // from which minutes are shown, as the command line does
const ASKED_MS = 2000; // between two questions whether workers are ready
const STARTING =
  "No worker is ready yet: the server is starting. The first start compiles the numerical kernels, which takes up to half a minute.";

/** Titles of the stages of a job, in order. */
const STAGES: readonly [stage: string, title: string][] = [
  ["upload", "Sending the mesh"],
  ["queued", "Waiting for a worker"],
  ...lists.stages.map(({ name, title }): [string, string] => [name, title]),
  ["show", "Drawing"],
];

export function openStages(name: string): void {
  byId("progress-left").textContent = "";
  byId("progress-name").textContent = name;
  byId("stages").replaceChildren(
    ...STAGES.map(([stage, title]) =>
      h("li", { "data-stage": stage, "data-state": "later" }, icon("check"), h("span", {}, title)),
    ),
  );
}

/** Return the stage of a job that has not ended. */
export function stageOf(job: Job): string {
  return job.status === "queued" ? "queued" : (job.stage ?? lists.stages[0]!.name);
}

export function titleOf(stage: string): string {
  return STAGES.find(([name]) => name === stage)?.[1] ?? stage;
}

/** Return the completed fraction of upload and job. */
export function shareOf(stage: string, done: number): number {
  return stage === "upload" ? UPLOAD * done : UPLOAD + (1 - UPLOAD) * done;
}

/** Mark the current stage; ``done`` is the completed fraction of the upload or of the job, 0..1. */
export function showStage(stage: string, done: number): void {
  const at = Math.max(STAGES.findIndex(([name]) => name === stage), 0);
  const bar = byId<HTMLProgressElement>("progress-bar");
  bar.value = shareOf(stage, done);
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

export function showProgress(job: Job): void {
  showStage(stageOf(job), job.progress);
  const isQueued = job.status === "queued";
  const place = isQueued && (job.queue_position ?? 0) > 1 ? `, ${job.queue_position! - 1} ahead of it` : "";
  const reason = isQueued && job.waits_for ? ` (${job.waits_for})` : "";
  byId("progress-left").textContent = left(job.seconds_left ?? null);
  byId("stages").querySelector("[data-stage=queued] span")!.textContent = `Waiting for a worker${place}${reason}`;
}

/** Return how long a job still takes, in words; empty if that is not known. */
function left(seconds: number | null): string {
  if (seconds === null) return "";
  return seconds < MINUTES_FROM_S ? `About ${plural(seconds, "second")} left` : `About ${plural(Math.round(seconds / 60), "minute")} left`;
}

/** Say why a job waits while no worker is ready, until the signal is aborted. */
export async function explainWaiting(signal: AbortSignal): Promise<void> {
  const note = byId("progress-wait");
  note.textContent = "";
  while (!signal.aborted) {
    await pause(ASKED_MS);
    const isWaiting = byId("stages").querySelector("[data-state=now]")?.getAttribute("data-stage") === "queued";
    const readiness = isWaiting && !signal.aborted ? await getReadiness() : null;
    const text = readiness?.ready === false ? STARTING : "";
    if (signal.aborted || note.textContent === text) continue;
    note.textContent = text;
    if (text !== "") announce(text);
  }
}
