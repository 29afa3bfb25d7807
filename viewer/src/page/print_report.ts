/** The report of a file for printing, in words. */

import type { PrintContact, PrintObject, PrintReport } from "./api";
import { h } from "./dom";
import { figure, plural } from "./text";

/** Return the elements that say what a file contains. ``names``: of the parts, by label. */
export function reportOf(report: PrintReport, names: readonly string[]): HTMLElement[] {
  const colors = new Map(report.slots.map(({ slot, color }) => [slot, color]));
  const parts = report.objects.filter(({ part }) => part !== null);
  const contacts = report.connectors === "none" ? [] : report.contacts;
  return [
    h("p", { className: "summary" }, summaryOf(report)),
    ...warningsOf(report).map((text) => h("p", { className: "small" }, text)),
    ...listOf("Parts", parts.map((one) => rowOf(h("i", { className: "swatch", style: `background: ${colors.get(one.slot)}` }), one.name, objectText(one)))),
    ...listOf("Contacts", contacts.map((one) => rowOf(mark(one), titleOf(one, names), contactText(one)))),
  ];
}

/** Return what a file contains in one or two sentences. */
export function summaryOf({ objects, slots, contacts, connectors, volume }: PrintReport): string {
  const made = `${plural(objects.length, "object")} in ${plural(slots.length, "filament")}, ${volumeText(volume)} of closed parts`;
  if (connectors === "none" || contacts.length === 0) return `${made}.`;
  const joined = contacts.filter(({ connector }) => connector !== null).length;
  return `${made}. ${joined} of ${plural(contacts.length, "contact")} have a ${connectors}.`;
}

function warningsOf({ objects, unit_of_mesh, scale }: PrintReport): string[] {
  const open = objects.filter(({ closed }) => !closed).length;
  const large = objects.filter(({ fits_bed }) => !fits_bed).length;
  return [
    ...(unit_of_mesh === null && scale === 1 ? ["The unit of the mesh is not known: its lengths are taken as millimetres. A longest side says how large it is."] : []),
    ...(open > 0 ? [`${plural(open, "part is", "parts are")} not closed: a slicer may leave out or repair such a part.`] : []),
    ...(large > 0 ? [`${plural(large, "object is", "objects are")} larger than the bed.`] : []),
  ];
}

function objectText({ closed, volume, size, slot, fits_bed }: PrintObject): string {
  const solid = closed && volume !== null ? `closed, ${volumeText(volume)}` : "not a closed solid, without connectors";
  const fits = fits_bed ? "" : ", larger than the bed";
  return `${solid}, ${size.map(figure).join(" × ")} mm, filament ${slot}${fits}`;
}

function titleOf({ parts: [one, other], pieces }: PrintContact, names: readonly string[]): string {
  return pieces === null ? `${names[one]} and ${names[other]}` : `${names[one]}, pieces ${pieces.join(" and ")}`;
}

function contactText({ connector, reason }: PrintContact): string {
  if (connector === null) return `no connector: ${reason}`;
  const { kind, diameter, hole_diameter, holes } = connector;
  return `${kind} of ${figure(diameter)} mm, ${plural(holes, "hole")} of ${figure(hole_diameter)} mm`;
}

function mark({ connector }: PrintContact): HTMLElement {
  return connector === null ? h("b", { className: "is-missing", "aria-hidden": "true" }, "–") : h("b", { "aria-hidden": "true" }, "✓");
}

function listOf(title: string, rows: readonly HTMLElement[]): HTMLElement[] {
  return rows.length === 0 ? [] : [h("h3", {}, title), h("ul", {}, ...rows)];
}

function rowOf(first: HTMLElement, title: string, text: string): HTMLElement {
  return h("li", {}, first, h("div", {}, h("b", {}, title), h("p", { className: "about" }, text)));
}

const volumeText = (cubicMillimetres: number): string =>
  cubicMillimetres < 1000 ? `${figure(cubicMillimetres)} mm³` : `${figure(cubicMillimetres / 1000)} cm³`;
