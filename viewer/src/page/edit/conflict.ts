/** The question after somebody else has edited the same job. */

import { byId, openDialog } from "../dom";
import { when } from "../text";
import { jobPath, requestJson } from "../api";
import type { Revision } from "./revisions";

/** Load the newer revision and repeat the own change, load it without the change, or go on without loading it. */
export type Choice = "repeat" | "load" | "later";

export async function askAboutConflict(job: string): Promise<Choice> {
  const dialog = byId<HTMLDialogElement>("conflict");
  byId("conflict-text").textContent = await described(job);
  dialog.returnValue = "later";
  openDialog(dialog);
  return new Promise((resolve) => {
    dialog.addEventListener("close", () => resolve(dialog.returnValue as Choice), { once: true });
  });
}

async function described(job: string): Promise<string> {
  try {
    const { made_by, made_at, what } = await requestJson<Revision>(jobPath(job, "/revisions/latest"));
    return `${made_by ?? "Somebody"} has edited the parts ${when(made_at)}: ${what}.`;
  } catch {
    return "Somebody has edited the parts.";
  }
}
