/** What the page says about the mesh of a job. */

import { nameOf, type Axis, type Job, type Report, type Structure } from "./api";
import { byId } from "./dom";
import { bytes, figure, plural, stem } from "./text";

const SIGNS: Record<string, string> = {
  micron: "µm",
  millimeter: "mm",
  centimeter: "cm",
  meter: "m",
  inch: "in",
  foot: "ft",
};
const IN_Z_UP: readonly (string | null)[] = ["stl", "3mf"]; // formats of jobs without a report

/** Write the name of a mesh and the facts about it into the head of the page. */
export function entitle(job: Job, faces: number): void {
  const name = nameOf(job);
  byId("title").textContent = name;
  byId("about").textContent = about(job, faces);
  document.title = `${stem(name)} – Cleave`;
}

/** Return a line of facts: faces, bytes, size and structure. */
function about(job: Job, faces: number): string {
  const report = job.mesh?.report ?? null;
  const size = report === null ? [] : [sizeOf(report)];
  return [plural(faces, "face"), bytes(job.input.size_bytes), ...size, ...structureOf(report?.structure ?? null)].join(" · ");
}

/** Return the axis that points up if the user has not chosen one. */
export function usualUp(job: Job): Axis {
  return job.mesh?.report?.shown_up ?? (IN_Z_UP.includes(job.input.format) ? "z" : "y");
}

/** Return the lengths of the bounding box, such as "60 × 40 × 5 mm"; lengths below a metre in centimetres or millimetres. */
function sizeOf({ lower, upper, unit }: Report): string {
  const lengths = upper.map((value, k) => value - lower[k]!);
  const longest = Math.max(...lengths);
  if (unit !== "meter" || longest >= 1) return written(lengths, SIGNS[unit ?? ""] ?? null);
  return longest >= 0.1 ? written(scaled(lengths, 100), "cm") : written(scaled(lengths, 1000), "mm");
}

function scaled(lengths: readonly number[], factor: number): number[] {
  return lengths.map((length) => factor * length);
}

function written(lengths: readonly number[], sign: string | null): string {
  return `${lengths.map(figure).join(" × ")}${sign === null ? "" : ` ${sign}`}`;
}

/** Return the counts of the structure of a file, such as "96 shells"; none if it is of one part. */
function structureOf(structure: Structure | null): string[] {
  const { shells, groups, materials } = structure ?? { shells: 0, groups: 0, materials: 0 };
  if (Math.max(shells, groups, materials) <= 1) return [];
  const counts: [number, string][] = [[shells, "shell"], [groups, "group"], [materials, "material"]];
  return counts.filter(([number]) => number > 0).map(([number, one]) => plural(number, one));
}
