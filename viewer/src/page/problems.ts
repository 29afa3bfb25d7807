/** Errors as sentences: what happened, and what to do next. */

export type Remedy = "choose" | "retry" | "parameters" | "key" | "jobs";

export interface Problem {
  readonly code: string;
  /** One sentence of the server. */
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

/** The problem of an error, whatever was thrown. */
export function problemOf(error: unknown): Problem {
  if (error instanceof ApiError) return { code: error.code, detail: error.message };
  return { code: "unreachable", detail: "The server does not answer." };
}

const KNOWN: Record<string, [title: string, next: string, remedy: Remedy]> = {
  unreachable: ["The server cannot be reached", "Check that it runs and that you are connected, then try again.", "retry"],
  too_large: ["The file is too large", "Reduce the mesh, or ask the operator to raise CLEAVE_MAX_UPLOAD_BYTES.", "choose"],
  limit_exceeded: ["The mesh is too large", "Reduce its number of faces, or ask the operator for a larger limit.", "choose"],
  invalid_mesh: ["This file cannot be read as a mesh", "Export it again from the program that made it, then choose it here.", "choose"],
  unsupported_format: ["This is not a format Cleave reads", "Convert it to OFF, OBJ, PLY, STL, GLB or glTF.", "choose"],
  unsupported_media_type: ["This is not a format Cleave reads", "Convert it to OFF, OBJ, PLY, STL, GLB or glTF.", "choose"],
  malformed_request: ["The upload was cut short", "Send the file again.", "retry"],
  invalid_parameters: ["A parameter is out of range", "Change it and run again.", "parameters"],
  job_not_found: ["This job is gone", "It was deleted, or the link is not complete. Choose a mesh to begin again.", "choose"],
  not_found: ["This job is gone", "The link is not complete. Choose a mesh to begin again.", "choose"],
  job_deleted: ["This job was deleted", "Choose a mesh to begin again.", "choose"],
  job_canceled: ["This job was stopped", "Send the mesh again to see its parts.", "retry"],
  canceled: ["Stopped", "Nothing was kept. Send the mesh again whenever you like.", "retry"],
  queue_unavailable: ["The server is starting or its queue is down", "Wait a moment, then try again.", "retry"],
  store_unavailable: ["The store of the server does not answer", "Wait a moment, then try again.", "retry"],
  insufficient_storage: ["The disk of the server is full", "Delete jobs that you no longer need, then try again.", "jobs"],
  too_many_jobs: ["Too many jobs are waiting", "Wait until one of them has finished, then try again.", "retry"],
  queue_full: ["Too many jobs are waiting", "Wait a moment, then try again.", "retry"],
  too_many_bytes: ["Enough was sent for this hour", "Try again later.", "retry"],
  too_slow: ["The upload came to a halt", "Send the file again over a better connection.", "retry"],
  foreign_site: ["This page may not send meshes", "Open the page at the address of the server itself.", "retry"],
  unauthorized: ["This server asks for a key", "Enter an API key of this server.", "key"],
  worker_lost: ["The mesh was too much for the worker", "Reduce its number of faces, then try again.", "choose"],
  out_of_memory: ["The mesh needs too much memory", "Reduce its number of faces, then try again.", "choose"],
  timed_out: ["The mesh took too long", "Reduce its number of faces, then try again.", "choose"],
  file_too_large: ["The result is too large to be stored", "Reduce its number of faces, then try again.", "choose"],
  input_lost: ["The mesh is no longer on the server", "Send it again.", "retry"],
  no_webgl: ["No 3D graphics here", "Switch on WebGL 2 in the settings of the browser, or use another one.", "retry"],
};

export function explain(problem: Problem): Explanation {
  const [title, next, remedy] = KNOWN[problem.code] ?? [
    "Something went wrong",
    "Try again; if it happens again, the log of the server has the details.",
    "retry",
  ];
  return { title, detail: problem.detail, next, remedy };
}
