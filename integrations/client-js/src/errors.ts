/** The errors of the client; their messages say what to do. */

import type { components } from "./schema.js";

type Schemas = components["schemas"];

/** The server did not answer, or what answered is no Cleave server. */
export class ServerUnreachable extends Error {
  override readonly name = "ServerUnreachable";
}

/** The server has refused the request; `problem` is its answer (RFC 9457). */
export class RequestRefused extends Error {
  override readonly name = "RequestRefused";

  constructor(readonly problem: Schemas["ProblemDocument"]) {
    super(problem.detail);
  }

  get status(): number {
    return this.problem.status;
  }

  /** Stable, for programs. */
  get code(): Schemas["ProblemDocument"]["code"] {
    return this.problem.code;
  }
}

/** The job has ended without a result: it failed or was canceled. */
export class JobEnded extends Error {
  override readonly name = "JobEnded";

  constructor(readonly job: Schemas["FailedJob"] | Schemas["CanceledJob"]) {
    super(`The job has no result: ${job.status === "failed" ? job.error.message : "it was canceled."}`);
  }
}
