/** Client for edits of parts: operations, revisions and labels. */

import { jobPath, newKey, request, requestJson } from "../api";
import { pause } from "../pause";
import { ApiError, isUnanswered } from "../problems";
import type { ChangedFaces, FaceRuns } from "./face_runs";

export interface Level {
  readonly segments?: number;
  readonly splits?: readonly number[];
}

export type Target = number | "new";

export type Operation =
  | { readonly op: "merge"; readonly parts: readonly number[] }
  | { readonly op: "assign"; readonly faces: FaceRuns; readonly to: Target }
  | { readonly op: "part"; readonly inside: FaceRuns; readonly outside: FaceRuns; readonly to: Target }
  | { readonly op: "cut"; readonly part: number; readonly stroke: FaceRuns }
  | { readonly op: "border"; readonly a: number; readonly b: number; readonly stroke: FaceRuns }
  | { readonly op: "smooth"; readonly parts: readonly number[] | null }
  | { readonly op: "name"; readonly part: number; readonly name: string }
  | { readonly op: "delete_name" | "lock" | "unlock"; readonly part: number }
  | { readonly op: "color"; readonly part: number; readonly color: string | null }
  | { readonly op: "class"; readonly part: number; readonly class: string | null }
  | { readonly op: "restore"; readonly revision: number; readonly level?: Level };

export interface Edit {
  readonly base: number;
  readonly level?: Level;
  readonly operations: readonly Operation[];
}

export interface Part {
  /** Empty for none. */
  readonly name: string;
  readonly color: string;
  /** Empty for none. */
  readonly class: string;
  readonly locked: boolean;
  readonly faces: number;
}

export interface Revision {
  readonly number: number;
  readonly parent: number;
  readonly made_at: string;
  readonly made_by: string | null;
  readonly what: string;
  readonly segments: number;
}

export interface Edited {
  /** Null for a preview. */
  readonly revision: Revision | null;
  readonly parts: readonly Part[];
  readonly changed: ChangedFaces;
}

/** An edit that takes longer than a request waits. */
interface Queued {
  readonly id: string;
  readonly status: "queued" | "succeeded" | "failed";
  readonly error: { readonly code: string; readonly message: string } | null;
}

const JSON_BODY = { "Content-Type": "application/json" };
const READY_PAUSE_MS = 1500; // between tries while the server prepares a mesh
const REPEAT_PAUSES_MS = [500, 1000, 2000, 4000]; // before a request whose response was lost is sent again

/** Send a request, and again if its response is lost: the server recognizes an edit by its key. */
async function answered<T>(send: () => Promise<T>): Promise<T> {
  for (const pauseMs of REPEAT_PAUSES_MS) {
    try {
      return await send();
    } catch (error) {
      if (!isUnanswered(error)) throw error;
      await pause(pauseMs);
    }
  }
  return send();
}

/** Make the next revision; null if it went through the queue, so that its parts are to be loaded. */
export async function postEdit(job: string, edit: Edit): Promise<Edited | null> {
  const headers = { ...JSON_BODY, "Idempotency-Key": newKey() };
  const options = { method: "POST", headers, body: JSON.stringify(edit) };
  const made = await answered(() => requestJson<Edited | Queued>(jobPath(job, "/edits"), options));
  if (!("status" in made)) return made;
  let queued = made;
  while (queued.status === "queued") {
    await pause(READY_PAUSE_MS);
    queued = await answered(() => requestJson<Queued>(jobPath(job, `/edits/${made.id}`)));
  }
  if (queued.error !== null) throw new ApiError({ code: queued.error.code, detail: queued.error.message }, 409);
  return null;
}

/** Return what an edit would make; waits while the server prepares the mesh, and calls ``onWait`` before. */
export async function previewEdit(job: string, edit: Edit, signal: AbortSignal, onWait: () => void): Promise<Edited> {
  const options = { method: "POST", headers: JSON_BODY, body: JSON.stringify(edit), signal };
  for (let wait = onWait; ; wait = () => undefined) {
    try {
      return await requestJson<Edited>(jobPath(job, "/edits/preview"), options);
    } catch (error) {
      if (!(error instanceof ApiError) || error.code !== "guide_not_ready" || signal.aborted) throw error;
      wait();
      await pause(READY_PAUSE_MS);
    }
  }
}

/** Store labels that were made elsewhere as the next revision. */
export async function putLabels(job: string, base: number, file: Blob, mediaType: string): Promise<void> {
  const headers = { "Content-Type": mediaType, "Idempotency-Key": newKey() };
  await answered(() => requestJson(jobPath(job, `/labels?base=${base}`), { method: "PUT", headers, body: file }));
}

/** Return the newest revision with its parts and its labels. */
export async function newestRevision(job: string): Promise<Revision & { parts: readonly Part[]; labels: Int32Array }> {
  const revision = await answered(() => requestJson<Revision & { parts: readonly Part[] }>(jobPath(job, "/revisions/latest")));
  const path = jobPath(job, `/labels?revision=${revision.number}&format=raw`);
  const raw = await answered(async () => (await request(path)).arrayBuffer());
  return { ...revision, labels: new Int32Array(raw) };
}
