/** Follows a job to its end by server-sent events, or by polling if the event stream fails. */

import { getJob, headers, jobPath, type Job } from "./api";
import { pause } from "./pause";
import { ApiError } from "./problems";

const ENDED = new Set(["succeeded", "failed", "canceled"]);
const POLL_MS = 700;
const LONGEST_PAUSE_MS = 5000;

export interface Follower {
  onJob(job: Job): void;
  /** Called after each poll: whether the server responded. */
  onConnection(isThere: boolean): void;
}

/** Return the job once it has ended. Throws ApiError if the job is gone; retries while the server is unreachable. */
export async function follow(id: string, follower: Follower, signal: AbortSignal): Promise<Job> {
  const ended = await stream(id, follower, signal).catch((error: unknown) => {
    if (signal.aborted || (error instanceof ApiError && error.status < 500)) throw error;
    return null;
  });
  return ended ?? poll(id, follower, signal);
}

export const hasEnded = (job: Job): boolean => ENDED.has(job.status);

async function stream(id: string, follower: Follower, signal: AbortSignal): Promise<Job | null> {
  const answer = await fetch(jobPath(id, "/events"), { headers: { ...headers(), Accept: "text/event-stream" }, signal });
  if (!answer.ok || answer.body === null) return null;
  const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
  let text = "";
  let ended: Job | null = null;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return ended;
    const events = (text + value).split(/\r?\n\r?\n/);
    text = events.pop() ?? "";
    for (const event of events) {
      const job = jobIn(event);
      if (job === null) continue;
      follower.onJob(job);
      if (hasEnded(job)) ended = job; // the service then closes the stream
    }
  }
}

function jobIn(event: string): Job | null {
  const lines = event.split(/\r?\n/);
  if (!lines.includes("event: status")) return null;
  const data = lines.flatMap((line) => (line.startsWith("data:") ? [line.slice(5).trimStart()] : []));
  return JSON.parse(data.join("\n")) as Job;
}

async function poll(id: string, follower: Follower, signal: AbortSignal): Promise<Job> {
  let pauseMs = POLL_MS;
  for (;;) {
    signal.throwIfAborted();
    try {
      const job = await getJob(id);
      follower.onConnection(true);
      follower.onJob(job);
      if (hasEnded(job)) return job;
      pauseMs = POLL_MS;
    } catch (error) {
      if (error instanceof ApiError && error.status < 500) throw error;
      follower.onConnection(false);
      pauseMs = Math.min(1.5 * pauseMs, LONGEST_PAUSE_MS);
    }
    await pause(pauseMs);
  }
}
