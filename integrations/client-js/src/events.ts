/** The events of a job, read from as many streams as it takes until the job has ended. */

import { EventSourceParserStream } from "eventsource-parser/stream";
import type { components } from "./schema.js";

type Job = components["schemas"]["JobDocument"];
const ENDED: ReadonlySet<string> = new Set<Job["status"]>(["succeeded", "failed", "canceled"]);
const RETRY_MS = 1000; // the service names the same time

/**
 * Yield the state of a job at every change.
 *
 * @param open returns the stream after an event; null or an empty one if there are no more
 */
export async function* jobEvents(open: (lastEventId?: string) => Promise<ReadableStream<Uint8Array> | null | undefined>, signal?: AbortSignal): AsyncGenerator<Job, void, undefined> {
  let last: string | undefined;
  for (;;) {
    const stream = await open(last);
    if (!stream) return;
    for await (const { id, data } of eventsOf(stream)) {
      last = id ?? last;
      const job = JSON.parse(data) as Job;
      yield job;
      if (ENDED.has(job.status)) return;
    }
    await pause(signal);
  }
}

async function* eventsOf(stream: ReadableStream<Uint8Array>): AsyncGenerator<{ id?: string | undefined; data: string }> {
  const reader = stream.pipeThrough(new TextDecoderStream() as ReadableWritablePair<string, Uint8Array>).pipeThrough(new EventSourceParserStream()).getReader();
  try {
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      yield value;
    }
  } finally {
    await reader.cancel();
  }
}

async function pause(signal?: AbortSignal): Promise<void> {
  await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
  signal?.throwIfAborted();
}
