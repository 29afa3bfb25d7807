/** Client for the parts of the HTTP API that the page uses. */

import { ApiError, UNEXPECTED, type Problem } from "./problems";
import type { Model } from "./sets";

export type Status = "queued" | "running" | "succeeded" | "failed" | "canceled";

export interface Job {
  readonly id: string;
  readonly status: Status;
  readonly stage: string | null;
  readonly progress: number;
  /** An estimate; null if there is none, missing in documents of earlier versions. */
  readonly seconds_left?: number | null;
  readonly queue_position: number | null;
  /** What a waiting job waits for, such as "compiling, once: 14 of 52". */
  readonly waits_for?: string | null;
  readonly created_at: string;
  readonly finished_at: string | null;
  readonly input: {
    readonly file_name: string | null;
    readonly format: string | null;
    readonly size_bytes: number;
    readonly sha256: string;
  };
  readonly parameters: Readonly<Record<string, unknown>>;
  readonly mesh: { readonly faces: number; readonly vertices: number; readonly report: Report | null } | null;
  readonly max_segments: number | null;
  readonly automatic_segments: number | null;
  /** The newest revision of the parts; 0 if they were not edited. */
  readonly revision?: number;
  readonly notes: readonly string[];
  readonly error: { readonly code: string; readonly message: string } | null;
}

export interface Report {
  /** Opposite corners of the bounding box. */
  readonly lower: readonly [number, number, number];
  readonly upper: readonly [number, number, number];
  /** Of the coordinates, such as "millimeter"; null if it is not known, missing in jobs of earlier versions. */
  readonly unit?: string | null;
  /** The axis that points up in pictures; missing in jobs of earlier versions. */
  readonly shown_up?: Axis;
  /** The number of parts for every value of the parameter ``structure``; null in jobs of earlier versions. */
  readonly structure: Structure | null;
}

export type Axis = "y" | "z";

export interface Structure {
  readonly shells: number;
  readonly groups: number;
  readonly materials: number;
}

export interface JobPage {
  readonly jobs: Job[];
  readonly next_cursor: string | null;
}

export interface Formats {
  readonly max_upload_bytes: number;
  readonly keys_required: boolean;
}

export interface Readiness {
  readonly ready: boolean;
  readonly missing: readonly string[];
}

export interface ParameterSchema {
  readonly properties: Record<string, Parameter>;
}

export interface Parameter {
  readonly title?: string;
  /** Titles of the values. */
  readonly "x-choices"?: Readonly<Record<string, string>>;
  readonly "x-about"?: string;
  /** Whether only people who know the algorithm need it. */
  readonly "x-advanced"?: boolean;
  readonly type?: string | string[];
  readonly enum?: (string | number | null)[];
  readonly anyOf?: Parameter[];
  readonly const?: unknown;
  readonly default?: unknown;
  readonly description?: string;
  readonly minimum?: number;
  readonly maximum?: number;
  readonly exclusiveMinimum?: number;
  readonly exclusiveMaximum?: number;
}

/** What a file for printing contains; lengths in mm. */
export interface PrintReport {
  /** Null if it is not known. */
  readonly unit_of_mesh: string | null;
  readonly scale: number;
  readonly connectors: string;
  readonly volume: number;
  readonly objects: readonly PrintObject[];
  readonly slots: readonly { readonly slot: number; readonly color: string }[];
  readonly contacts: readonly PrintContact[];
}

export interface PrintObject {
  readonly name: string;
  /** Null for a dowel. */
  readonly part: number | null;
  readonly slot: number;
  readonly closed: boolean;
  readonly volume: number | null;
  readonly size: readonly number[];
  readonly fits_bed: boolean;
}

export interface PrintContact {
  readonly parts: readonly [number, number];
  /** The numbers of two pieces of one part; null between two parts. */
  readonly pieces: readonly number[] | null;
  readonly connector: { readonly kind: string; readonly diameter: number; readonly hole_diameter: number; readonly holes: number } | null;
  readonly reason: string | null;
}

const KEY = "cleave.key";

/** The API key stored in this browser; empty if the server requires none. */
export const apiKey = {
  get: (): string => localStorage.getItem(KEY) ?? "",
  set: (key: string): void => localStorage.setItem(KEY, key),
  forget: (): void => localStorage.removeItem(KEY),
};

export function headers(): Record<string, string> {
  const key = apiKey.get();
  return key === "" ? {} : { Authorization: `Bearer ${key}` };
}

let formats: Promise<Formats> | null = null;

function forgetFormats(error: unknown): never {
  formats = null;
  throw error;
}

/** Return the name of the mesh of a job. */
export const nameOf = (job: Job): string => job.input.file_name ?? "mesh";

/** Return the path of a job, relative to the page. */
export const jobPath = (id: string, rest = ""): string => `v1/jobs/${encodeURIComponent(id)}${rest}`;

export const getJob = (id: string): Promise<Job> => requestJson(jobPath(id));
export const getFormats = (): Promise<Formats> => (formats ??= requestJson<Formats>("v1/formats").catch(forgetFormats));
export const getMethods = (): Promise<ParameterSchema> => requestJson("v1/methods");

export const getPrintReport = (id: string, query: string): Promise<PrintReport> => requestJson(jobPath(id, `/print.json${query}`));

export function listJobs(cursor: string | null): Promise<JobPage> {
  return requestJson(`v1/jobs?limit=50${cursor === null ? "" : `&cursor=${encodeURIComponent(cursor)}`}`);
}

export async function deleteJob(id: string): Promise<void> {
  await request(jobPath(id), { method: "DELETE" });
}

export async function cancelJob(id: string): Promise<void> {
  await request(jobPath(id, "/cancel"), { method: "POST" });
}

/** Check the API key before something is sent. Throws ApiError if the server requires another one. */
export async function checkKey(): Promise<void> {
  if ((await getFormats()).keys_required) await request("v1/jobs?limit=1");
}

/** Run a job again with other parameters; the server has its file. */
export function rerun(id: string, parameters: Readonly<Record<string, unknown>>): Promise<Job> {
  return makingOneJob(parameters, async (key) => {
    const headers = { "Content-Type": "application/json", "Idempotency-Key": key };
    return requestJson<Job>(jobPath(id, "/rerun"), { method: "POST", headers, body: JSON.stringify(parameters) });
  });
}

/** Return what the server lacks to run jobs; null if it does not respond. */
export async function getReadiness(): Promise<Readiness | null> {
  const answer = await fetch("readyz").catch(() => null);
  return answer === null ? null : ((await answer.json().catch(() => null)) as Readiness | null);
}

export async function getBlob(path: string, signal?: AbortSignal): Promise<Blob> {
  return (await request(path, signal === undefined ? {} : { signal })).blob();
}

/** Send a request and return its response. Throws ApiError for an error response, TypeError if the server is unreachable. */
export async function request(path: string, options: RequestInit = {}): Promise<Response> {
  const answer = await fetch(path, { ...options, headers: { ...headers(), ...options.headers } });
  if (!answer.ok) throw new ApiError(problemIn(await answer.text(), answer.status), answer.status);
  return answer;
}

/** Send a request and return the JSON of its response. Errors as of ``request``, and ApiError if the response is not from Cleave. */
export async function requestJson<T>(path: string, options: RequestInit = {}): Promise<T> {
  return parsed<T>(await (await request(path, options)).text());
}

/** Upload a mesh and the files that belong to it; ``onSent`` receives the fraction of bytes sent. */
export function submit(
  model: Model,
  parameters: Readonly<Record<string, unknown>>,
  signal: AbortSignal,
  onSent: (share: number) => void,
): Promise<Job> {
  const form = new FormData();
  form.append("parameters", JSON.stringify(parameters));
  for (const { path, file } of model.files) form.append("mesh", file, path);
  return makingOneJob(model, async (key) => {
    const { status, responseText } = await upload(form, { ...headers(), "Idempotency-Key": key }, signal, onSent);
    if (status >= 300) throw new ApiError(problemIn(responseText, status), status);
    return parsed<Job>(responseText);
  });
}

/** Send a form with XMLHttpRequest: fetch does not tell how much was sent. */
function upload(
  form: FormData,
  fields: Readonly<Record<string, string>>,
  signal: AbortSignal,
  onSent: (share: number) => void,
): Promise<XMLHttpRequest> {
  return new Promise((resolve, reject) => {
    const exchange = new XMLHttpRequest();
    exchange.open("POST", "v1/jobs");
    for (const [name, value] of Object.entries(fields)) exchange.setRequestHeader(name, value);
    exchange.upload.onprogress = (event) => event.lengthComputable && onSent(event.loaded / event.total);
    exchange.onload = () => resolve(exchange);
    exchange.onerror = () => reject(new TypeError("The server is not responding."));
    exchange.onabort = () => reject(new DOMException("Stopped.", "AbortError"));
    signal.addEventListener("abort", () => exchange.abort());
    exchange.send(form);
  });
}

/** Keys of submissions whose response was lost: the job may have been made. */
const unanswered = new WeakMap<object, string>();

/** Send a submission; if its response is lost and it is sent again, it has the same key, so that there is no second job. */
async function makingOneJob(submission: object, send: (key: string) => Promise<Job>): Promise<Job> {
  const key = unanswered.get(submission) ?? newKey();
  unanswered.set(submission, key);
  let isAnswered = true;
  try {
    return await send(key);
  } catch (error) {
    isAnswered = error instanceof ApiError && error.status < 500;
    throw error;
  } finally {
    if (isAnswered) unanswered.delete(submission);
  }
}

/** Return a text that no other request has; crypto.randomUUID exists over HTTPS only. */
export function newKey(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}

const NO_ANSWER = { code: UNEXPECTED, detail: "A proxy in front of Cleave answers, but Cleave itself does not: it may be starting." };

/** What answers of a proxy mean, which do not come from Cleave. */
const OF_PROXIES: Readonly<Record<number, Problem>> = {
  413: {
    code: "too_large",
    detail: "A proxy in front of Cleave refuses uploads of this size: its operator can raise the limit, in nginx client_max_body_size.",
  },
  502: NO_ANSWER,
  503: NO_ANSWER,
  504: NO_ANSWER,
};

function parsed<T>(text: string): T {
  try {
    return JSON.parse(text) as T;
  } catch {
    throw new ApiError(NO_ANSWER, 502); // for example the page for signing in of a proxy
  }
}

function problemIn(text: string, status: number): Problem {
  try {
    const { code, detail } = JSON.parse(text) as Partial<Problem>;
    if (typeof code === "string" && typeof detail === "string") return { code, detail };
  } catch {
    // The response is not from Cleave, for example an HTML error page of a proxy.
  }
  return OF_PROXIES[status] ?? { code: status === 401 ? "unauthorized" : UNEXPECTED, detail: `The server responded with status ${status}.` };
}
