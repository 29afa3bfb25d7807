/** The dialog Download: downloads of the present cut, a picture, and commands that produce the same result. */

import type { CleaveViewer } from "../component/element";
import { apiKey, getBlob, getMethods, jobPath, nameOf, requestJson, type Job } from "./api";
import { byId, h, icon, openDialog, save, toast } from "./dom";
import { EditedSession } from "./edit/edited_session";
import lists from "./lists.json";
import { explain, problemOf } from "./problems";
import type { Result, Session } from "./session";
import { capitalized, plural, stem } from "./text";

interface Download {
  readonly id: string;
  readonly title: string;
  readonly about: string;
  /** End of the URL path. */
  readonly path: string;
  /** End of the file name. */
  readonly ending: string;
}

const DOWNLOADS: readonly Download[] = [
  ...lists.formats.map(modelDownload),
  { id: "json", title: "Labels", about: "The part of every face, as JSON", path: "labels", ending: "-labels.json" },
];

export class DownloadDialog {
  readonly #dialog = byId<HTMLDialogElement>("download");
  readonly #viewer: CleaveViewer;
  readonly #shown: () => Result | null;
  readonly #onPrint: () => void;

  /** ``onPrint`` opens the dialog of files for printing. */
  constructor(viewer: CleaveViewer, shown: () => Result | null, onPrint: () => void) {
    this.#viewer = viewer;
    this.#shown = shown;
    this.#onPrint = onPrint;
    byId("open-download").addEventListener("click", () => this.open());
    byId("copy-link").addEventListener("click", () => void copy(location.href, "Link copied."));
    for (const id of ["curl", "python"])
      byId(`copy-${id}`).addEventListener("click", () => void copy(byId(id).textContent, "Copied."));
  }

  open(): void {
    const shown = this.#shown();
    if (shown === null) return;
    byId("download-title").textContent = `Download ${plural(shown.session.parts.length, "part")}`;
    byId("downloads").replaceChildren(
      ...DOWNLOADS.map((item) => this.#row(item.id, item.title, item.about, () => this.#download(item))),
      this.#row("png", "Picture", "This view as PNG, without a background", () => this.#savePicture()),
      this.#row("print", "Print", "3MF with connectors and filaments", async () => this.#print()),
    );
    const hidden = shown.session.work.hidden.size;
    byId("download-hidden").hidden = hidden === 0;
    byId("download-hidden").textContent = `${plural(hidden, "hidden part")} ${hidden === 1 ? "is" : "are"} in the files, too.`;
    openDialog(this.#dialog);
    void this.#writeLines(shown);
  }

  async #writeLines(shown: Result): Promise<void> {
    const chosen = await chosenParameters(shown.job.parameters);
    byId("curl").textContent = curlLines(shown, chosen);
    byId("python").textContent = pythonLines(shown, chosen);
  }

  #row(id: string, title: string, about: string, act: () => Promise<void>): HTMLElement {
    const button = h("button", { type: "button", className: "download", "data-format": id }, icon("download"));
    button.append(h("b", {}, title), h("span", {}, about));
    button.addEventListener("click", () => {
      button.setAttribute("aria-busy", "true");
      act()
        .catch((error: unknown) => toast(explain(problemOf(error)).title))
        .finally(() => button.removeAttribute("aria-busy"));
    });
    return h("li", {}, button);
  }

  async #download({ path, ending }: Download): Promise<void> {
    const { job, session } = this.#shown()!;
    const address = jobPath(job.id, `/${path}${session.query}`);
    const fileName = `${stem(nameOf(job))}-${session.parts.length}${ending}`;
    if (path === "labels") {
      const document = await requestJson<object>(address);
      const names = session.parts.map((id) => session.nameOf(id));
      save(new Blob([JSON.stringify({ ...document, names })], { type: "application/json" }), fileName);
    } else {
      save(await getBlob(address + nameQuery(session)), fileName);
    }
  }

  #print(): void {
    this.#dialog.close();
    this.#onPrint();
  }

  async #savePicture(): Promise<void> {
    save(await this.#viewer.picture(), `${stem(nameOf(this.#shown()!.job))}.png`);
  }
}

/** Return the download of a model; its title in the list is a name, a comma and a description. */
function modelDownload({ name, title, extension, path }: (typeof lists.formats)[number]): Download {
  const [short, about] = title.split(", ");
  const kind = path === `model${extension}` ? "" : `-${stem(path)}`;
  return { id: name, title: short!, about: capitalized(about ?? ""), path, ending: `${kind}${extension}` };
}

/** Return the query string with the names of the parts, by label: 0, 1, ... in the order of the parts. */
export function nameQuery({ parts, work }: Session): string {
  const named = parts.flatMap((id, label) => (work.names.has(id) ? [`${label}:${work.names.get(id)}`] : []));
  return named.map((name) => `&name=${encodeURIComponent(name)}`).join("");
}

/** Return the parameters that differ from the defaults; all of them if the defaults cannot be loaded. */
async function chosenParameters(parameters: Job["parameters"]): Promise<[string, unknown][]> {
  const schema = await getMethods().catch(() => null);
  return Object.entries(parameters).filter(([name, value]) => schema?.properties[name]?.default !== value);
}

function curlLines({ job, session }: Result, chosen: [string, unknown][]): string {
  const fileName = nameOf(job);
  const root = new URL(".", document.baseURI).href;
  const key = apiKey.get() === "" ? "" : ` -H "Authorization: Bearer $CLEAVE_KEY"`;
  const form = [`mesh=@${fileName}`, ...(chosen.length === 0 ? [] : [`parameters=${JSON.stringify(Object.fromEntries(chosen))}`])];
  return [
    `curl --fail-with-body${key} ${form.map((field) => `-F ${shellWord(field)}`).join(" ")} ${root}v1/jobs`,
    `curl --fail-with-body${key} -o ${shellWord(`${stem(fileName)}.glb`)} "${root}${jobPath(job.id)}/model.glb${session.query}${nameQuery(session)}"`,
    `curl --fail-with-body${key} "${root}${jobPath(job.id)}/labels${session.query}"`,
  ].join("\n");
}

function pythonLines(result: Result, chosen: [string, unknown][]): string {
  return result.session.query.startsWith("?revision=") ? revisionLines(result) : segmentLines(result, chosen);
}

/** Return lines that get the parts of a revision, which were made by hand. */
function revisionLines({ job, session }: Result): string {
  const root = new URL(".", document.baseURI).href.replace(/\/$/, "");
  const key = apiKey.get() === "" ? "" : ', api_key=os.environ["CLEAVE_KEY"]';
  const revision = session.query.replace("?revision=", "");
  return [
    ...(key === "" ? [] : ["import os", ""]),
    "from cleave.client import Client",
    "",
    `with Client("${root}"${key}) as client:`,
    `    labels = client.labels(client.job("${job.id}"), revision=${revision}).labels  # (F,) part of every face`,
    `    client.download("${job.id}", "model.glb", ${JSON.stringify(`${stem(nameOf(job))}.glb`)}, revision=${revision})`,
  ].join("\n");
}

function segmentLines({ job, session }: Result, chosen: [string, unknown][]): string {
  // Before the first edit of a tool is stored, the files are those of the automatic result.
  const { tree, work } = session instanceof EditedSession ? session.levels : session;
  const level = tree.levelOf(work.cut);
  const values = chosen.map(([name, value]) => `${name}=${literal(value)}`).join(", ");
  const call = values === "" ? "mesh" : `mesh, segcore.SegmentationParameters(${values})`;
  return [
    "import segcore",
    "",
    `mesh = segcore.read_mesh(${JSON.stringify(nameOf(job))})`,
    `hierarchy = segcore.segment(${call})`,
    ...(level === null ? [`hierarchy = segcore.keep_splits(hierarchy, [${tree.splitsOf(work.cut).join(", ")}])`] : []),
    `labels = hierarchy.labels(${level ?? ""})  # (F,) part 0..${session.parts.length - 1} of every face`,
  ].join("\n");
}

function shellWord(text: string): string {
  return /^[\w.,:@%+/-]+$/.test(text) ? text : `'${text.replaceAll("'", `'\\''`)}'`;
}

function literal(value: unknown): string {
  if (value === null) return "None";
  if (typeof value === "boolean") return value ? "True" : "False";
  return JSON.stringify(value);
}

async function copy(text: string | null, confirmation: string): Promise<void> {
  try {
    await navigator.clipboard.writeText(text ?? "");
    toast(confirmation);
  } catch {
    toast("The browser does not allow copying. Select the text and copy it by hand.");
  }
}
