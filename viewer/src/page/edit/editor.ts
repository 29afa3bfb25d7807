/** The parts of a job as a person edits them: what is shown, what is stored, and the edits that are on their way. */

import { nodeOfPart, type CleaveViewer, type Partition } from "../../component/element";
import type { Job } from "../api";
import { announce, toast } from "../dom";
import { ApiError, explain, isUnanswered, problemOf } from "../problems";
import type { Session } from "../session";
import { plural } from "../text";
import { levelOf, partOfLevel } from "./automatic";
import { askAboutConflict } from "./conflict";
import { EditedSession } from "./edited_session";
import { changedLabels, successors } from "./face_runs";
import { renumbered } from "./renumbering";
import { newestRevision, postEdit, previewEdit, putLabels, type Edited, type Operation, type Part } from "./revisions";
import { Undo } from "./undo";

export interface EditorHost {
  readonly viewer: CleaveViewer;
  job(): Job | null;
  session(): Session | null;
  /** Show a session in place of the present one. */
  replace(make: (onChange: (news?: string) => void) => Session): void;
}

/** Parts that are stored, or that a level of the automatic result has. */
export interface Parts {
  readonly labels: Int32Array;
  readonly parts: readonly Part[];
}

export class Editor {
  readonly #host: EditorHost;
  /** Called after the shown parts have changed. */
  onChange: () => void = () => undefined;
  #undo = new Undo(0);
  /** The newest revision that is known; 0 for none. */
  #base = 0;
  /** The parts of the base. */
  #stored: Parts | null = null;
  /** The parts that are shown without previews; null if a level of the automatic result is shown in the tree. */
  #shown: Parts | null = null;
  /** Whether the shown parts are those of the base; false for those of a level that no edit has changed yet. */
  #isStored = false;
  /** The session of the automatic result. */
  #levels: Session | null = null;
  #sending: Promise<unknown> = Promise.resolve();
  #waiting = 0;
  #isPreview = false;
  /** Counts the jobs that were opened, so that answers about an earlier one are recognized. */
  #opened = 0;

  constructor(host: EditorHost) {
    this.#host = host;
  }

  get parts(): readonly Part[] {
    return this.#shown?.parts ?? [];
  }

  /** (F) the part of each face of the file; null before anything is edited. */
  get labels(): Int32Array | null {
    return this.#shown?.labels ?? null;
  }

  /** Whether the parts of a revision are shown; false for those of a level of the automatic result. */
  get isStored(): boolean {
    return this.#isStored;
  }

  /** The query string that selects the shown parts in the API. */
  get query(): string {
    return this.#isStored ? `?revision=${this.#base}` : this.#levels!.query;
  }

  get base(): number {
    return this.#base;
  }

  get isSaving(): boolean {
    return this.#waiting > 0;
  }

  get canUndo(): boolean {
    return this.#isStored && this.#undo.before !== null;
  }

  get canRedo(): boolean {
    return this.#isStored && this.#undo.after !== null;
  }

  /** Begin with the newest revision of a job whose automatic result is shown. */
  async open(job: Job, levels: Session): Promise<void> {
    this.#opened++;
    this.#levels = levels;
    this.#shown = this.#stored = null;
    this.#isStored = false;
    this.#base = job.revision ?? 0;
    this.#undo = new Undo(this.#base);
    this.onChange();
    if (this.#base > 0) await this.#load(job.id);
  }

  close(): void {
    this.#opened++;
    this.#levels = this.#shown = this.#stored = null;
    this.#isStored = false;
  }

  /** Make the shown level the parts that tools change; they become a revision with the first edit. */
  begin(): boolean {
    if (this.#shown !== null) return true;
    const [levels, viewer] = [this.#levels, this.#host.viewer];
    const labels = levels === null ? null : viewer.labelsOfCut(levels.work.cut);
    if (levels === null || labels === null) {
      toast("This job is from an earlier version, whose files have no numbers of faces: run it again to edit its parts.");
      return false;
    }
    this.#shown = { labels, parts: levels.parts.map((id) => partOfLevel(viewer, levels, id)) };
    if (this.#base === 0) this.#stored = this.#shown;
    this.#showParts(levels);
    return true;
  }

  /** Show the tree again if no edit has followed begin(). */
  end(): void {
    if (!this.#isStored && !this.isSaving) this.#leave();
  }

  /** Show the automatic result again; the next edit makes a revision from its level. */
  showLevels(): void {
    this.#leave();
    announce("The automatic parts are shown. The edited ones stay stored.");
  }

  #leave(): void {
    if (this.#shown === null || this.#levels === null) return;
    this.#shown = null;
    this.#isStored = false;
    this.#host.viewer.partition = null;
    const levels = this.#levels;
    this.#host.replace(() => levels);
    this.onChange();
  }

  /** Show the newest revision again. */
  async showNewest(): Promise<void> {
    const job = this.#host.job();
    if (job === null) return;
    const before = this.#base;
    await this.#load(job.id);
    if (before !== this.#base) this.#noteRevision();
  }

  /** Store operations on the shown parts as the next revision. Resolves with whether they are stored and shown. */
  edit(operations: readonly Operation[], done: string): Promise<boolean> {
    this.#waiting++;
    const [opened, before, base] = [this.#opened, this.#shown, this.#base];
    const sent = this.#sending.then(() => {
      if (opened !== this.#opened) return this.#refuse();
      if (before === null || base === this.#base) return this.#send(operations, done);
      // An edit that was sent in the meantime may have renumbered parts.
      return this.#send(renumbered(operations, successors(before.labels, this.#shown!.labels)), done);
    });
    this.#sending = sent.catch(() => undefined);
    return sent.finally(() => this.#waiting--);
  }

  /** Return the parts that operations would make. */
  async preview(operations: readonly Operation[], signal: AbortSignal): Promise<Parts> {
    await this.#sending;
    const onWait = () => toast("The server prepares this mesh for its first edit.");
    const edited = await previewEdit(this.#host.job()!.id, this.#document(operations), signal, onWait);
    return { parts: edited.parts, labels: changedLabels(this.#stored!.labels, edited.changed) };
  }

  /** Show a preview in place of the parts; ``strong`` is the part that stands out. */
  show(preview: Parts, strong: number): void {
    const { viewer } = this.#host;
    const session = this.#host.session();
    if (session === null) return;
    this.#isPreview = true;
    const count = preview.parts.length;
    viewer.partition = partitionOf(preview);
    viewer.hiddenParts = new Set([...session.work.hidden].map((id) => nodeOfPart(session.numberOf(id) ?? 0, count)));
    viewer.selected = [nodeOfPart(strong, count)];
  }

  /** Show the parts without preview and strokes. */
  drop(): void {
    const [session, { viewer }] = [this.#host.session(), this.#host];
    if (this.#shown === null || session === null) return;
    this.#isPreview = false;
    viewer.partition = partitionOf(this.#shown);
    viewer.hiddenParts = session.work.hidden;
    viewer.selected = session.modes.selected;
  }

  /** Whether the viewer shows other parts than the session. */
  get isPreview(): boolean {
    return this.#isPreview;
  }

  async undo(): Promise<void> {
    await this.#restore(this.#undo.before, -1, "Undone");
  }

  async redo(): Promise<void> {
    await this.#restore(this.#undo.after, 1, "Redone");
  }

  /** Store labels from a file as the next revision. */
  async importLabels(file: Blob, mediaType: string): Promise<void> {
    const job = this.#host.job();
    if (job === null) return;
    await this.#sending;
    try {
      await putLabels(job.id, this.#base, file, mediaType);
      if (this.#host.job() !== job) return;
      await this.#load(job.id);
      this.#noteRevision();
      announce(`Labels loaded: ${plural(this.parts.length, "part")}.`);
    } catch (error) {
      if (isConflict(error) && (await askAboutConflict(job.id)) !== "later") await this.showNewest();
      else toast(savingFailed(error));
    }
  }

  /** Make the base the last step that undo returns to. */
  #noteRevision(): void {
    this.#undo.add(this.#base);
    this.#host.session()?.setModes({}); // the buttons of undo and redo
  }

  async #restore(revision: number | null, by: 1 | -1, done: string): Promise<void> {
    if (revision === null) return;
    const level = revision === 0 && this.#levels !== null ? { level: levelOf(this.#levels) } : {};
    this.#undo.move(by);
    if (await this.edit([{ op: "restore", revision, ...level }], done)) return;
    this.#undo.move(-by as 1 | -1);
    this.#host.session()?.setModes({});
  }

  #document(operations: readonly Operation[]) {
    const level = this.#isStored || this.#levels === null ? null : levelOf(this.#levels);
    if (level === null) return { base: this.#base, operations };
    const named: Operation[] = this.#shown!.parts.flatMap(({ name }, part) => (name === "" ? [] : [{ op: "name", part, name }]));
    if (this.#base === 0) return { base: 0, level, operations: [...named, ...operations] };
    return { base: this.#base, operations: [{ op: "restore", revision: 0, level } as const, ...named, ...operations] };
  }

  #refuse(): boolean {
    toast("The last change was not saved: another model was opened.");
    return false;
  }

  async #send(operations: readonly Operation[], done: string): Promise<boolean> {
    const job = this.#host.job();
    const opened = this.#opened;
    if (job === null || !this.begin()) return false;
    try {
      const edited = await postEdit(job.id, this.#document(operations));
      if (opened !== this.#opened) return false; // it is stored, but another job is shown
      if (edited === null) await this.#load(job.id);
      else this.#took(edited);
      if (operations[0]?.op !== "restore") this.#noteRevision();
    } catch (error) {
      if (opened !== this.#opened) return this.#refuse();
      if (isConflict(error)) return this.#settle(job.id, operations, done);
      toast(savingFailed(error));
      this.drop();
      return false;
    }
    announce(`${done}. ${plural(this.parts.length, "part")}.`);
    return true;
  }

  /** Ask what is to happen after somebody else has edited the job. */
  async #settle(job: string, operations: readonly Operation[], done: string): Promise<boolean> {
    const choice = await askAboutConflict(job);
    if (choice === "later") {
      this.drop();
      return false;
    }
    const [before, opened] = [this.#shown!, this.#opened];
    await this.#load(job);
    if (opened !== this.#opened) return this.#refuse();
    this.#noteRevision();
    if (choice === "load") return false;
    return this.#send(renumbered(operations, successors(before.labels, this.#shown!.labels)), done);
  }

  #took({ revision, parts, changed }: Edited): void {
    this.#base = revision!.number;
    const before = this.#host.session()!;
    this.#stored = this.#shown = { parts, labels: changedLabels(this.#stored!.labels, changed) };
    this.#isStored = true;
    this.#showParts(before);
  }

  /** Show the newest revision of the present job. */
  async #load(job: string): Promise<void> {
    const opened = this.#opened;
    const { number, parts, labels } = await newestRevision(job);
    if (opened !== this.#opened) return;
    this.#base = number;
    this.#stored = this.#shown = { parts, labels };
    this.#isStored = true;
    this.#showParts(this.#host.session()!);
  }

  /** Show the parts in a new session that carries the selection of another one over. */
  #showParts(before: Session): void {
    const { viewer } = this.#host;
    const shown = this.#shown!;
    const selected = this.#carried(before, before.modes.selected);
    const hidden = this.#carried(before, [...before.work.hidden]);
    this.#isPreview = false;
    viewer.partition = partitionOf(shown);
    const modes = { ...before.modes, selected };
    this.#host.replace((onChange) => new EditedSession(this, viewer.tree!, this.#levels!, shown, modes, hidden, onChange));
    this.onChange();
  }

  /** Return the nodes of parts of a session in the tree of the shown parts. */
  #carried(before: Session, ids: readonly number[]): number[] {
    const { labels, parts } = this.#shown!;
    if (ids.length === 0) return [];
    const old = before instanceof EditedSession ? before.labels : this.#host.viewer.labelsOfCut(before.work.cut);
    if (old === null) return [];
    const own = before.numbersOf(ids);
    const after = successors(old, labels, new Set(own));
    const numbers = own.map((part) => after[part]).filter((part) => part !== undefined);
    return [...new Set(numbers)].map((part) => nodeOfPart(part, parts.length));
  }
}

function partitionOf({ labels, parts }: Parts): Partition {
  return { labels, colors: parts.map(({ color }) => color) };
}

function savingFailed(error: unknown): string {
  const reason = error instanceof ApiError ? error.message : `${explain(problemOf(error)).title}.`;
  return isUnanswered(error) ? `It is not known whether the change was saved. ${reason}` : `Not saved: ${reason}`;
}

function isConflict(error: unknown): boolean {
  return error instanceof ApiError && error.code === "revision_conflict";
}
