/** The client: a method for each step from a mesh to its parts, and `api` for every other operation. */

import createClient, { type Client } from "openapi-fetch";
import { JobEnded, RequestRefused, ServerUnreachable } from "./errors.js";
import { jobEvents } from "./events.js";
import { bodyOf, queryText, type Mesh } from "./requests.js";
import type { components, paths } from "./schema.js";

export type { Mesh };
type Schemas = components["schemas"];
export type Job = Schemas["JobDocument"];
export type SucceededJob = Schemas["SucceededJob"];
/** A level of the parts: a number of segments, a granularity, a cut by splits, or a revision; by default the automatic one. */
export type Level = Pick<NonNullable<paths["/v1/jobs/{job_id}/labels"]["get"]["parameters"]["query"]>, "segments" | "granularity" | "splits" | "revision">;

/** A level, and the tolerance of what is a copy. */
export type PartsOptions = NonNullable<paths["/v1/jobs/{job_id}/parts"]["get"]["parameters"]["query"]>;

type ModelPath = Extract<keyof paths, `/v1/jobs/{job_id}/${"model" | "parts" | "preview"}.${string}`>;
/** A file of a job: `model.glb`, `model.3mf`, `parts.zip`, `preview.png`, ... */
export type ModelFile = ModelPath extends `/v1/jobs/{job_id}/${infer File}` ? File : never;
/** The query parameters of a file. */
export type ModelOptions<File extends ModelFile> = NonNullable<paths[`/v1/jobs/{job_id}/${File}`]["get"]["parameters"]["query"]>;

export interface CleaveOptions {
  /** Is sent as `Authorization: Bearer KEY`. A key in a public page can be read by everybody who opens it. */
  apiKey?: string;
  /** Replaces the function `fetch` of the platform. */
  fetch?: (request: Request) => Promise<Response>;
}

export interface Call {
  /** Ends the call; an unfinished job goes on. */
  signal?: AbortSignal;
}

type Query = NonNullable<paths["/v1/jobs"]["post"]["parameters"]["query"]>;
/** `file_name`, `format`, `unit`, `up`, `webhook` as in the API. */
export interface SubmitOptions extends Call, Omit<Query, "parameters" | "segments" | "granularity"> {
  /** Parameters of the segmentation; those that are missing have their defaults. */
  parameters?: Schemas["Parameters"];
  /** A repeated request with this text creates no second job. */
  idempotencyKey?: string;
  /** Compute the result again, even if the server has one for this mesh. */
  recompute?: boolean;
}

const POLL_S = 20; // of one request: well below the 60 s after which nginx, by default, ends it

type MediaTypes = "application/json" | "application/problem+json";

export class Cleave {
  /** Every operation of the API, typed by its OpenAPI document: `cleave.api.GET("/v1/formats")`. */
  readonly api: Client<paths, MediaTypes>;
  readonly server: string;

  /** @param server where the service is, with its path if it has one: `https://example.com/cleave` */
  constructor(server: string | URL, options: CleaveOptions = {}) {
    this.server = String(server).replace(/\/+$/, "");
    this.api = createClient<paths, MediaTypes>({
      baseUrl: this.server,
      querySerializer: queryText,
      ...(options.apiKey === undefined ? {} : { headers: { Authorization: `Bearer ${options.apiKey}` } }),
      ...(options.fetch === undefined ? {} : { fetch: options.fetch }),
    });
  }

  /** Submit a mesh: a file, its bytes, or a list of one mesh and the files that it refers to. */
  async submit(mesh: Mesh, options: SubmitOptions = {}): Promise<Job> {
    const { signal, parameters, idempotencyKey, recompute, ...named } = options;
    const { body, fileName } = bodyOf(mesh);
    const name = named.file_name ?? fileName;
    const query: Query = {
      ...named,
      ...(name === undefined || body instanceof FormData ? {} : { file_name: name }),
      ...(parameters === undefined ? {} : { parameters: JSON.stringify(parameters) }),
    };
    const header = {
      ...(idempotencyKey === undefined ? {} : { "idempotency-key": idempotencyKey }),
      ...(recompute === true ? { "cache-control": "no-cache" } : {}),
    };
    return answer<Job>(
      this.api.POST("/v1/jobs", {
        params: { query, header },
        body: body as never, // the types of openapi-typescript have a string in place of bytes
        bodySerializer: (bytes) => bytes as BodyInit,
        headers: body instanceof FormData ? { "Content-Type": null } : { "Content-Type": "application/octet-stream" },
        ...signalOf(signal),
      }),
    );
  }

  /** Return the state of a job, at once or when it has ended, at the latest after `waitSeconds`. */
  job(id: string, options: Call & { waitSeconds?: number } = {}): Promise<Job> {
    const query = options.waitSeconds === undefined ? {} : { wait: options.waitSeconds };
    return answer<Job>(this.api.GET("/v1/jobs/{job_id}", { params: { path: { job_id: id }, query }, ...signalOf(options.signal) }));
  }

  /**
   * Wait until a job has succeeded, without a time limit.
   *
   * @throws JobEnded if the job fails or is canceled
   */
  async wait(id: string, options: Call = {}): Promise<SucceededJob> {
    for (;;) {
      const job = await this.job(id, { ...options, waitSeconds: POLL_S });
      if (job.status === "succeeded") return job;
      if (job.status === "failed" || job.status === "canceled") throw new JobEnded(job);
    }
  }

  /** Yield the state of a job at every change, until it has ended. Works with API keys, unlike EventSource. */
  async *events(id: string, options: Call = {}): AsyncGenerator<Job, void, undefined> {
    yield* jobEvents(async (lastEventId) => {
      const params = { path: { job_id: id }, header: lastEventId === undefined ? {} : { "last-event-id": Number(lastEventId) } };
      return answer<ReadableStream<Uint8Array> | undefined>(this.api.GET("/v1/jobs/{job_id}/events", { params, parseAs: "stream", ...signalOf(options.signal) }));
    }, options.signal);
  }

  /** Return the label of every face, in the order of the file. */
  async labels(id: string, level: Level = {}, options: Call = {}): Promise<Int32Array> {
    const params = { path: { job_id: id }, query: { ...level, format: "raw" as const } };
    const bytes = await answer<ArrayBuffer>(this.api.GET("/v1/jobs/{job_id}/labels", { params, parseAs: "arrayBuffer", ...signalOf(options.signal) }));
    return new Int32Array(bytes);
  }

  /** Return what can be measured of the parts at a level: size, place, neighbours, and which of them are copies. */
  parts(id: string, options: PartsOptions = {}, call: Call = {}): Promise<Schemas["PartsDocument"]> {
    const params = { path: { job_id: id }, query: options };
    return answer<Schemas["PartsDocument"]>(this.api.GET("/v1/jobs/{job_id}/parts", { params, ...signalOf(call.signal) }));
  }

  /** Return the tree of cuts, which has the parts of every level; see PartTree. */
  hierarchy(id: string, options: Call = {}): Promise<Schemas["HierarchyDocument"]> {
    return answer<Schemas["HierarchyDocument"]>(this.api.GET("/v1/jobs/{job_id}/hierarchy", { params: { path: { job_id: id } }, ...signalOf(options.signal) }));
  }

  /** Return the URL of a file of a job, for loaders and `<cleave-viewer>`. It contains no API key. */
  modelUrl<File extends ModelFile>(id: string, file: File, options: ModelOptions<File> = {} as ModelOptions<File>): string {
    const query = queryText(options);
    return `${this.server}/v1/jobs/${encodeURIComponent(id)}/${file}${query === "" ? "" : `?${query}`}`;
  }
}

function signalOf(signal: AbortSignal | undefined): { signal?: AbortSignal } {
  return signal === undefined ? {} : { signal };
}

/** Return the body of an answer; throw the problem if it has one. The type is given, because openapi-fetch loses tuples. */
async function answer<Data>(call: Promise<{ data?: unknown; error?: unknown; response: Response }>): Promise<Data> {
  const { data, error, response } = await call.catch((reason: unknown) => {
    if (reason instanceof TypeError) throw new ServerUnreachable("The server did not answer: start it, check its URL, and if this is a page, CLEAVE_CORS_ORIGINS.", { cause: reason });
    throw reason;
  });
  if (response.ok) return data as Data;
  if (isProblem(error)) throw new RequestRefused(error);
  throw new ServerUnreachable(`The answer was ${response.status} ${response.statusText}: is this a Cleave server?`);
}

function isProblem(error: unknown): error is Schemas["ProblemDocument"] {
  return typeof error === "object" && error !== null && "code" in error && "detail" in error;
}
