/** The dialog Print: options of the file for printing, its download, and what it contains. */

import { getBlob, getPrintReport, jobPath, nameOf } from "./api";
import { announce, byId, h, openDialog, save } from "./dom";
import { nameQuery } from "./download";
import lists from "./lists.json";
import { reportOf, summaryOf } from "./print_report";
import { explain, problemOf } from "./problems";
import type { Result } from "./session";
import { stem } from "./text";

const { defaults, choices, most, bedPattern } = lists.print;
type Field = HTMLInputElement | HTMLSelectElement;

export class PrintDialog {
  readonly #dialog = byId<HTMLDialogElement>("print");
  readonly #form = byId<HTMLFormElement>("print-form");
  readonly #report = byId("print-report");
  readonly #shown: () => Result | null;

  constructor(shown: () => Result | null) {
    this.#shown = shown;
    this.#fill();
    this.#form.addEventListener("change", () => this.#report.replaceChildren());
    this.#form.addEventListener("submit", (event) => {
      event.preventDefault();
      const isFile = (event.submitter as HTMLButtonElement | null)?.value !== "report";
      void this.#make(isFile);
    });
  }

  open(): void {
    this.#report.replaceChildren();
    openDialog(this.#dialog);
  }

  /** Fill the form with the choices, the limits and the defaults. The values stay while the page is open. */
  #fill(): void {
    for (const [name, values] of Object.entries(choices))
      this.#field(name).append(...values.map(({ name, title }) => h("option", { value: name }, title)));
    for (const [name, value] of Object.entries(most)) this.#field<HTMLInputElement>(name).max = String(value);
    for (const [name, value] of Object.entries(defaults)) if (value !== null) this.#field(name).value = String(value);
    const bed = this.#field<HTMLInputElement>("bed");
    bed.pattern = bedPattern;
    bed.addEventListener("change", () => (bed.value = bed.value.trim().toLowerCase().replaceAll(/\s*[x×*]\s*/g, "x")));
  }

  #field<T extends Field = Field>(name: string): T {
    return byId<T>(`print-${name}`);
  }

  async #make(isFile: boolean): Promise<void> {
    const shown = this.#shown();
    if (shown === null || this.#dialog.ariaBusy === "true") return;
    this.#dialog.ariaBusy = "true";
    this.#report.replaceChildren(h("p", { className: "summary is-busy" }, "Making solids of the parts."));
    try {
      const { job, session } = shown;
      // Without a name for it in the file, what the page shows upwards stands on the bed.
      const query = `${session.query}${nameQuery(session)}${this.#query()}&up=${session.modes.up}`;
      if (isFile) save(await getBlob(jobPath(job.id, `/print.3mf${query}`)), `${stem(nameOf(job))}-print.3mf`);
      const report = await getPrintReport(job.id, query);
      this.#report.replaceChildren(...reportOf(report, session.parts.map((id) => session.nameOf(id))));
      announce(summaryOf(report));
    } catch (error) {
      const { title, detail } = explain(problemOf(error));
      this.#report.replaceChildren(h("p", { className: "summary", role: "alert" }, h("b", {}, `${title}. `), detail));
    } finally {
      this.#dialog.ariaBusy = "false";
    }
  }

  /** Return the part of the query string with the values that are not the defaults. */
  #query(): string {
    const given = Object.entries(defaults).map(([name, usual]) => [name, this.#field(name).value, String(usual ?? "")] as const);
    return given.map(([name, value, usual]) => (value === usual ? "" : `&${name}=${encodeURIComponent(value)}`)).join("");
  }
}
