/** The looks of a model: its parts, the original colours and textures, or both. */

import type { Look } from "./cleave-viewer";
import type { Model } from "./glb";
import type { Original } from "./original";
import { reasonOf, unreachable } from "./status";

export type { Look };

/** The original look cannot be shown; the message says why. */
export class NoOriginal extends Error {}

export function lookNamed(name: string | null): Look {
  return name === "original" || name === "both" ? name : "parts";
}

/** Load the file that has everything of the input. Throws NoOriginal, or AbortError if the signal is aborted. */
export async function loadOriginal(
  source: string | null,
  headers: Record<string, string>,
  model: Model,
  signal: AbortSignal,
  yieldToEventLoop: () => Promise<void>,
): Promise<Original> {
  if (source === null) throw new NoOriginal("There is no file with the original look.");
  const data = await download(source, headers, signal).catch((error: unknown) => {
    if (signal.aborted || error instanceof NoOriginal) throw error;
    throw new NoOriginal(unreachable(source));
  });
  // Loaded on demand: only this look needs the reader of glTF files.
  const { readOriginal } = await import("./original");
  try {
    return await readOriginal(data, model, yieldToEventLoop);
  } catch (error) {
    throw new NoOriginal(`The browser cannot show the file: ${error instanceof Error ? error.message : "it is damaged"}`);
  }
}

async function download(source: string, headers: Record<string, string>, signal: AbortSignal): Promise<ArrayBuffer> {
  const answer = await fetch(source, { headers, signal });
  if (!answer.ok) throw new NoOriginal(await reasonOf(answer));
  return answer.arrayBuffer();
}
