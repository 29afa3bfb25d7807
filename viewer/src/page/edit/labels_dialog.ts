/** The dialog Labels: the classes, labels by class for training sets, and labels that were made elsewhere. */

import { getBlob, jobPath, type Job } from "../api";
import { announce, byId, openDialog, save, toast } from "../dom";
import { ApiError, explain, problemOf } from "../problems";
import { stem } from "../text";
import { classes, keepClasses } from "./classes";
import type { Editor } from "./editor";

const MEDIA_TYPES: Readonly<Record<string, string>> = {
  seg: "text/plain",
  txt: "text/plain",
  npy: "application/x-npy",
  json: "application/json",
  bin: "application/octet-stream",
};

export class LabelsDialog {
  readonly #dialog = byId<HTMLDialogElement>("labels");
  readonly #list = byId<HTMLTextAreaElement>("class-list");
  readonly #job: () => Job | null;
  readonly #editor: Editor;

  /** ``onClasses`` is called after the list of classes has changed. */
  constructor(job: () => Job | null, editor: Editor, onClasses: () => void) {
    this.#job = job;
    this.#editor = editor;
    byId("open-labels").addEventListener("click", () => this.open());
    const keep = (text: string) => {
      this.#list.value = keepClasses(text).join("\n");
      onClasses();
    };
    this.#list.addEventListener("change", () => keep(this.#list.value));
    byId("export-classes").addEventListener("click", () => save(new Blob([`${classes().join("\n")}\n`]), "classes.txt"));
    listenToFile("import-classes", async (file) => {
      keep(await file.text());
      announce(`${classes().length} classes loaded.`);
    });
    for (const format of ["seg", "json"]) byId(`export-${format}`).addEventListener("click", () => void this.#export(format));
    listenToFile("import-labels", (file) => this.#import(file));
  }

  open(): void {
    this.#list.value = classes().join("\n");
    const isStored = this.#editor.isStored;
    for (const id of ["export-seg", "export-json"]) byId<HTMLButtonElement>(id).disabled = !isStored;
    openDialog(this.#dialog);
  }

  /** Save the number of the class of every face: those of the list first, so that they are the same for all meshes. */
  async #export(format: string): Promise<void> {
    const job = this.#job();
    if (job === null) return;
    const used = this.#editor.parts.map((part) => part.class).filter((name) => name !== "");
    const wanted = [...new Set([...classes(), ...used])].map((name) => `&class=${encodeURIComponent(name)}`).join("");
    try {
      const labels = await getBlob(jobPath(job.id, `/labels${this.#editor.query}&by=class&format=${format}${wanted}`));
      save(labels, `${stem(job.input.file_name ?? "mesh")}-classes.${format}`);
    } catch (error) {
      toast(error instanceof ApiError ? error.message : explain(problemOf(error)).title);
    }
  }

  async #import(file: File): Promise<void> {
    const ending = file.name.split(".").at(-1)!.toLowerCase();
    const mediaType = MEDIA_TYPES[ending];
    if (mediaType === undefined) return toast("Labels are read from .seg, .txt, .npy, .json and .bin files.");
    const isRuns = ending === "json" && /"lengths"\s*:/.test(await file.text());
    this.#dialog.close();
    await this.#editor.importLabels(file, isRuns ? "application/vnd.cleave.runs+json" : mediaType);
  }
}

/** Call ``use`` with each file that is chosen in an input. */
function listenToFile(id: string, use: (file: File) => Promise<void>): void {
  const input = byId<HTMLInputElement>(id);
  input.addEventListener("change", () => {
    const [file] = input.files ?? [];
    input.value = ""; // so that the same file can be chosen again
    if (file !== undefined) void use(file);
  });
}
