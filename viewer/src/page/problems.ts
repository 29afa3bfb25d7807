/** Explains errors to users: what happened, and what to do next. */

import lists from "./lists.json";

export type Remedy = "choose" | "retry" | "parameters" | "key" | "jobs";

export interface Problem {
  readonly code: string;
  /** One sentence from the server. */
  readonly detail: string;
}

export interface Explanation {
  readonly title: string;
  readonly detail: string;
  readonly next: string;
  readonly remedy: Remedy;
}

export class ApiError extends Error {
  readonly code: string;
  readonly status: number;

  constructor(problem: Problem, status: number) {
    super(problem.detail);
    this.code = problem.code;
    this.status = status;
  }
}

/** Return the problem that describes a thrown error. */
export function problemOf(error: unknown): Problem {
  if (error instanceof ApiError) return { code: error.code, detail: error.message };
  return { code: "unreachable", detail: "The server is not responding." };
}

/** The code of answers that are not from Cleave. */
export const UNEXPECTED = "unexpected";

/** Whether it is unknown if a request has arrived: its response was lost, or a proxy has responded in place of Cleave. */
export function isUnanswered(error: unknown): boolean {
  return !(error instanceof ApiError) || (error.code === UNEXPECTED && error.status >= 500);
}

const FORMATS = new Intl.ListFormat("en", { type: "disjunction" }).format(lists.inputFormats.map(({ title }) => title));

const KNOWN: Record<string, [title: string, next: string, remedy: Remedy]> = {
  unreachable: ["The server cannot be reached", "Check that it is running and that you are connected, then try again.", "retry"],
  too_large: ["The file is too large", "Simplify the mesh, or ask the operator to raise CLEAVE_MAX_UPLOAD_BYTES.", "choose"],
  limit_exceeded: ["The mesh is too large", "Simplify the mesh, or ask the operator to raise the limit.", "choose"],
  invalid_mesh: ["This file cannot be read as a mesh", "Export it again from the program that created it, then choose it here.", "choose"],
  unsupported_format: ["Cleave does not read this format", `Convert the file to ${FORMATS}.`, "choose"],
  unsupported_media_type: ["Cleave does not read this format", `Convert the file to ${FORMATS}.`, "choose"],
  invalid_file_set: ["These files are not one mesh", "Choose one mesh and the files that belong to it.", "choose"],
  no_mesh: ["There is no mesh among these files", `Choose a mesh: ${FORMATS}, with the files that belong to it.`, "choose"],
  too_many_files: ["These are too many files", "Choose fewer at a time.", "choose"],
  unreadable: ["The files cannot be read", "They may have been moved or changed. Choose them again.", "choose"],
  malformed_request: ["The upload was incomplete", "Send the file again.", "retry"],
  invalid_parameters: ["A parameter is out of range", "Change it and run again.", "parameters"],
  job_not_found: ["This job does not exist", "It was deleted, or the link is incomplete. Choose a mesh to start again.", "choose"],
  not_found: ["This job does not exist", "The link is incomplete. Choose a mesh to start again.", "choose"],
  job_deleted: ["This job was deleted", "Choose a mesh to start again.", "choose"],
  job_canceled: ["This job was stopped", "Send the mesh again to see its parts.", "retry"],
  canceled: ["Stopped", "There is no result. Send the mesh again to see its parts.", "retry"],
  queue_unavailable: ["The server is starting, or its queue is unavailable", "Wait a moment, then try again.", "retry"],
  store_unavailable: ["The storage of the server is unavailable", "Wait a moment, then try again.", "retry"],
  insufficient_storage: ["The disk of the server is full", "Delete jobs that you no longer need, then try again.", "jobs"],
  too_many_jobs: ["Too many jobs are waiting", "Wait until one of them has ended, then try again.", "retry"],
  queue_full: ["Too many jobs are waiting", "Wait a moment, then try again.", "retry"],
  too_many_bytes: ["The upload limit of this hour is reached", "Try again later.", "retry"],
  too_slow: ["The upload was too slow", "Send the file again over a faster connection.", "retry"],
  foreign_site: ["The server does not accept requests from this site", "Open the page at the address of the server itself.", "retry"],
  unauthorized: ["This server requires an API key", "Enter an API key that the operator gave you.", "key"],
  worker_lost: ["The worker died while it ran this job", "Simplify the mesh, then try again.", "choose"],
  out_of_memory: ["The mesh needs too much memory", "Simplify the mesh, then try again.", "choose"],
  timed_out: ["The mesh took too long", "Simplify the mesh, then try again.", "choose"],
  missing_package: ["The server lacks a package for this", "Ask the operator to install it.", "retry"],
  file_too_large: ["The result is too large to be stored", "Simplify the mesh, then try again.", "choose"],
  input_lost: ["The mesh is no longer on the server", "Send it again.", "retry"],
  no_webgl: ["3D graphics are not available", "Enable WebGL 2 in the browser settings, or use another browser.", "retry"],
};

export function explain(problem: Problem): Explanation {
  const [title, next, remedy] = KNOWN[problem.code] ?? [
    "Something went wrong",
    "Try again. If it happens again, the log of the server has the details.",
    "retry",
  ];
  return { title, detail: problem.detail, next, remedy };
}
