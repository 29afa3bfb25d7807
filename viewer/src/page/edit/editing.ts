/** Everything that edits parts, as the page uses it. */

import type { Job } from "../api";
import type { Session } from "../session";
import { Batch, type BatchModel } from "./batch";
import { Copies } from "./copies";
import { Described } from "./described";
import { EditedSession } from "./edited_session";
import { Editor, type EditorHost } from "./editor";
import { LabelsDialog } from "./labels_dialog";
import { RevisionCard } from "./revision_card";
import { Toolbox } from "./toolbox";

export class Editing {
  readonly #host: EditorHost;
  readonly #editor: Editor;
  readonly #toolbox: Toolbox;
  readonly #described: Described;
  readonly #copies: Copies;
  readonly #card: RevisionCard;
  readonly #batch: Batch;

  /** ``onOpen`` is called with the id of a job that is to be shown next. */
  constructor(host: EditorHost, onOpen: (job: string) => void) {
    const session = () => host.session();
    this.#host = host;
    this.#editor = new Editor(host);
    this.#toolbox = new Toolbox(host.viewer, this.#editor, session);
    this.#described = new Described(host.viewer, this.#editor, session);
    this.#copies = new Copies(host, this.#editor);
    this.#card = new RevisionCard(this.#editor, () => this.#toolbox.reset());
    this.#batch = new Batch(onOpen);
    new LabelsDialog(() => host.job(), this.#editor, () => this.#described.update());
    this.#editor.onChange = () => this.#card.update();
  }

  /** Begin with a job whose automatic result is shown. */
  open(job: Job, levels: Session): Promise<void> {
    this.#batch.show(job.id);
    return this.#editor.open(job, levels);
  }

  close(): void {
    this.#toolbox.reset();
    this.#editor.close();
    this.#batch.show(null);
  }

  /** Update the controls after the session has changed. */
  update(): void {
    this.#described.update();
    this.#copies.update();
    this.#toolbox.update();
  }

  /** Merge exactly these parts: in the tree if they are a group of it, else as an edit. */
  merge(ids: readonly number[]): void {
    const session = this.#host.session();
    if (session === null || ids.length < 2) return;
    const group = session instanceof EditedSession ? null : session.groupOf(ids);
    if (group !== null) return session.mergeBelow(group);
    const parts = session.numbersOf(ids);
    void this.#editor.edit([{ op: "merge", parts }], `${parts.length} parts merged`);
  }

  /** Label models one after the other. */
  label(models: readonly BatchModel[]): void {
    this.#batch.begin(models);
  }
}
