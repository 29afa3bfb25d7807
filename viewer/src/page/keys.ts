/** The API key of this browser: entered, checked, and forgotten. */

import { apiKey, getFormats } from "./api";
import { byId, openDialog } from "./dom";
import { forgetStates } from "./kept";

/** Ask for a key in a dialog; ``onEntered`` is called when it is stored. */
export function askForKey(onEntered: () => void): void {
  openDialog(byId<HTMLDialogElement>("key-dialog"));
  byId("key-form").onsubmit = () => {
    apiKey.set(byId<HTMLInputElement>("key").value.trim());
    byId<HTMLInputElement>("key").value = "";
    onEntered();
  };
}

/** Say whose jobs this browser sees, on the start page and in the list of jobs. */
export async function describeKey(): Promise<void> {
  const { keys_required: isRequired } = await getFormats();
  const hasKey = apiKey.get() !== "";
  byId("key-line").hidden = !isRequired;
  byId("key-state").textContent = hasKey ? "This browser stores an API key." : "This server requires an API key.";
  byId("key-enter").textContent = hasKey ? "Enter another key" : "Enter a key";
  byId("key-forget").hidden = byId("jobs-forget").hidden = !hasKey;
  byId("jobs-owner").textContent = isRequired
    ? "These are the jobs of the API key that this browser stores."
    : "Everybody who can open this page sees these jobs.";
}

/** Listen to the buttons that enter and forget the key; the states of its jobs are forgotten with it. */
export function listenToKeys(): void {
  byId("key-enter").addEventListener("click", () => askForKey(() => location.reload()));
  for (const id of ["key-forget", "jobs-forget"])
    byId(id).addEventListener("click", () => {
      apiKey.forget();
      forgetStates();
      location.assign(location.pathname);
    });
}
