/** The hint that a file has a structure of its own, with buttons that cut along it. */

import type { Job, Structure } from "./api";
import { byId, h } from "./dom";
import { plural } from "./text";

const KINDS: readonly [name: keyof Structure, one: string][] = [
  ["shells", "shell"],
  ["groups", "group"],
  ["materials", "material"],
];

/** Offer the structures of the file of a job, unless the job follows one; ``run`` runs it again along one. */
export function offerStructure(job: Job, run: (structure: string) => void): void {
  const counts = job.mesh?.report?.structure ?? null;
  const isOffered = counts !== null && job.parameters["structure"] === "none";
  const offered = isOffered ? KINDS.filter(([name]) => counts[name] > 1) : [];
  byId("structure-hint").hidden = offered.length === 0;
  byId("structure-choices").replaceChildren(
    ...offered.map(([name, one]) =>
      h("button", { type: "button", "data-structure": name, onclick: () => run(name) }, plural(counts![name], one)),
    ),
  );
}
