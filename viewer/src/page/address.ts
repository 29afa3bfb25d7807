/** Reads and writes the state of a job as the fragment of the URL, so that a link shows the same view. */

import type { View } from "../component/element";
import type { Axis } from "./api";
import { LOOKS, type Modes } from "./session";
import { FIRST_STATE, type JobState } from "./state";

export interface Address {
  readonly job: string | null;
  /** Null if the address names the job alone. */
  readonly state: JobState | null;
  /** The splits of a link of an earlier version, in place of level and cuts by hand. */
  readonly splits: readonly number[] | null;
}

export function readAddress(hash: string): Address {
  const values = new URLSearchParams(hash.replace(/^#/, ""));
  const splits = values.get("cut");
  const isBare = [...values.keys()].every((key) => key === "job");
  return { job: values.get("job"), state: isBare ? null : stateIn(values), splits: splits === null ? null : integers(splits) };
}

export function writeAddress(job: string, state: JobState): string {
  const { level, split, merged, hidden, names, modes, view, beside } = state;
  const values = new URLSearchParams({ job });
  if (level !== null) values.set("k", String(level));
  for (const [key, ids] of [["split", split], ["merge", merged], ["hide", hidden], ["sel", modes.selected ?? []]] as const)
    if (ids.length > 0) values.set(key, ids.join("."));
  if (modes.explode !== undefined) values.set("explode", modes.explode.toFixed(2));
  const show = [modes.wireframe && "wires", modes.concavity && "concavity", modes.lines === false && "nolines"].filter(Boolean);
  if (show.length > 0) values.set("show", show.join("."));
  if (modes.up !== undefined) values.set("up", modes.up);
  if (modes.look !== undefined) values.set("look", modes.look);
  for (const [id, name] of Object.entries(names)) values.set(`n${id}`, name);
  if (view !== null) values.set("view", writeView(view));
  if (beside !== null) values.set("beside", beside);
  return `#${values}`;
}

function stateIn(values: URLSearchParams): JobState {
  const level = values.get("k");
  const names = [...values].flatMap(([key, name]) => (/^n\d+$/.test(key) ? [[Number(key.slice(1)), name] as const] : []));
  return {
    ...FIRST_STATE,
    level: level === null ? null : Number(level) || 1,
    split: integers(values.get("split")),
    merged: integers(values.get("merge")),
    hidden: integers(values.get("hide")),
    names: Object.fromEntries(names),
    modes: modesIn(values),
    view: readView(values.get("view")),
    beside: values.get("beside"),
  };
}

function modesIn(values: URLSearchParams): Partial<Modes> {
  const show = new Set((values.get("show") ?? "").split("."));
  const up = axisNamed(values.get("up"));
  const look = LOOKS.find((look) => look === values.get("look"));
  return {
    selected: integers(values.get("sel")),
    explode: Math.min(Math.max(Number(values.get("explode")) || 0, 0), 1),
    wireframe: show.has("wires"),
    concavity: show.has("concavity"),
    lines: !show.has("nolines"),
    ...(up === null ? {} : { up }),
    ...(look === undefined ? {} : { look }),
  };
}

function writeView({ azimuth, polar, distance, target }: View): string {
  return [azimuth, polar, distance, ...target].map((value) => Number(value.toFixed(3))).join("_");
}

function readView(text: string | null): View | null {
  const [azimuth, polar, distance, x, y, z] = (text ?? "").split("_").map(Number);
  const values = [azimuth, polar, distance, x, y, z];
  if (values.some((value) => value === undefined || !Number.isFinite(value)) || !(distance! > 0)) return null;
  return { azimuth: azimuth!, polar: polar!, distance: distance!, target: [x!, y!, z!] };
}

function axisNamed(text: string | null): Axis | null {
  return text === "y" || text === "z" ? text : null;
}

function integers(text: string | null): number[] {
  return (text ?? "").split(".").flatMap((part) => (/^\d+$/.test(part) ? [Number(part)] : []));
}
