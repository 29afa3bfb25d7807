/** Keeps the states of jobs in this browser, so that a job that is opened from the list is as it was left. */

import type { JobState } from "./state";
import { stored } from "./storage";

const KEY = "cleave.states";
const MOST = 100; // jobs; set by hand: a state has a few hundred bytes

type States = Record<string, JobState>;

export function keptState(job: string): JobState | null {
  return read()[job] ?? null;
}

export function keepState(job: string, state: JobState): void {
  const { [job]: _, ...others } = read();
  write({ ...Object.fromEntries(Object.entries(others).slice(1 - MOST)), [job]: state });
}

export function forgetState(job: string): void {
  const { [job]: _, ...others } = read();
  write(others);
}

export function forgetStates(): void {
  localStorage.removeItem(KEY);
}

function read(): States {
  return (stored(KEY) ?? {}) as States;
}

function write(states: States): void {
  try {
    localStorage.setItem(KEY, JSON.stringify(states));
  } catch {
    // The storage is full or forbidden: the address has the state, too.
  }
}
