/** Values that this browser keeps. */

import { toast } from "../dom";

/** Keep a value; says so if the storage is full or forbidden. */
export function keep(key: string, value: unknown): void {
  try {
    localStorage.setItem(key, JSON.stringify(value));
  } catch {
    toast("This browser does not keep the list: its storage is full or forbidden.");
  }
}
