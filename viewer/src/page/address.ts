/** Reads and writes the state of the page as the fragment of its URL, so that a link shows the same view. */

import type { View } from "../component/element";
import type { Axis } from "./api";
import { LOOKS, type Modes, type Session, type Work } from "./session";

export interface Address {
  readonly job: string | null;
  /** A second job to show beside the first. */
  readonly beside: string | null;
  readonly view: View | null;
  readonly values: URLSearchParams;
}

export function readAddress(hash: string): Address {
  const values = new URLSearchParams(hash.replace(/^#/, ""));
  return { job: values.get("job"), beside: values.get("beside"), view: readView(values.get("view")), values };
}

/** Return the edits and the display modes that a fragment contains. */
export function readState({ values }: Address, { tree, firstModes }: Session): { work: Partial<Work>; modes: Partial<Modes> } {
  const level = values.get("k");
  const splits = values.get("cut");
  const cut = splits !== null ? tree.cutOfSplits(integers(splits)) : level !== null ? tree.cutAt(Number(level) || 1) : null;
  const show = new Set((values.get("show") ?? "").split("."));
  const names = [...values].flatMap(([key, name]) => (/^n\d+$/.test(key) ? [[Number(key.slice(1)), name] as const] : []));
  return {
    work: {
      ...(cut === null ? {} : { cut }),
      hidden: new Set(integers(values.get("hide")).filter((id) => id < tree.nodes.length)),
      names: new Map(names.filter(([id]) => id < tree.nodes.length)),
    },
    modes: {
      selected: integers(values.get("sel")),
      explode: Math.min(Math.max(Number(values.get("explode")) || 0, 0), 1),
      wireframe: show.has("wires"),
      concavity: show.has("concavity"),
      lines: !show.has("nolines"),
      up: axisNamed(values.get("up")) ?? firstModes.up,
      look: LOOKS.find((look) => look === values.get("look")) ?? firstModes.look,
    },
  };
}

export function writeAddress(job: string, session: Session, view: View | null, beside: string | null): string {
  const { tree, work, modes } = session;
  const values = new URLSearchParams({ job });
  const level = tree.levelOf(work.cut);
  if (level === null) values.set("cut", tree.splitsOf(work.cut).join("."));
  else if (level !== session.automaticSegments) values.set("k", String(level));
  if (work.hidden.size > 0) values.set("hide", [...work.hidden].join("."));
  if (modes.selected.length > 0) values.set("sel", modes.selected.join("."));
  if (modes.explode > 0) values.set("explode", modes.explode.toFixed(2));
  const show = [modes.wireframe && "wires", modes.concavity && "concavity", !modes.lines && "nolines"].filter(Boolean);
  if (show.length > 0) values.set("show", show.join("."));
  if (modes.up !== session.firstModes.up) values.set("up", modes.up);
  if (modes.look !== session.firstModes.look) values.set("look", modes.look);
  for (const [id, name] of work.names) values.set(`n${id}`, name);
  if (view !== null) values.set("view", writeView(view));
  if (beside !== null) values.set("beside", beside);
  return `#${values}`;
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
