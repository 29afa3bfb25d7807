/** Values that this browser keeps. */

import { toast } from "./dom";

/** Return a value; null if there is none, or if it cannot be read. */
export function stored(key: string): unknown {
  try {
    return JSON.parse(localStorage.getItem(key) ?? "null");
  } catch {
    return null;
  }
}

/** Keep a value; says so if the storage is full or forbidden. */
export function keep(key: string, value: unknown): void {
  try {
    localStorage.setItem(key, JSON.stringify(value));
  } catch {
    toast("This browser does not keep the list: its storage is full or forbidden.");
  }
}
