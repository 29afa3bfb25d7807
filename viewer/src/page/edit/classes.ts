/** The classes that parts of many meshes are labelled with, kept in this browser. */

import { keep, stored } from "../storage";

const KEY = "cleave.classes";
const MOST = 1000; // that the API takes
const LONGEST = 200; // characters, as in the API

export function classes(): string[] {
  const kept = stored(KEY);
  return Array.isArray(kept) ? kept.filter((name) => typeof name === "string") : [];
}

/** Keep the classes of a text, one a line; returns them. */
export function keepClasses(text: string): string[] {
  const names = text.split(/\r?\n/).map((line) => line.trim().slice(0, LONGEST));
  const kept = [...new Set(names.filter((name) => name !== ""))].slice(0, MOST);
  keep(KEY, kept);
  return kept;
}
