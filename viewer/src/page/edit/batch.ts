/** Models that are labelled one after the other: their list, what is done, and the way to the next one. */

import { byId, h, openDialog } from "../dom";
import { keep, stored } from "../storage";
import { plural } from "../text";

export interface BatchModel {
  readonly job: string;
  readonly name: string;
}

type State = "todo" | "unsure" | "done";

const KEY = "cleave.batch";
const TITLES: Readonly<Record<State, string>> = { todo: "To do", unsure: "Unsure", done: "Done" };

interface Kept {
  readonly models: readonly BatchModel[];
  readonly states: Readonly<Record<string, State>>;
}

export class Batch {
  readonly #onOpen: (job: string) => void;
  readonly #state = byId<HTMLSelectElement>("batch-state");
  #kept: Kept = read();
  #job: string | null = null;

  constructor(onOpen: (job: string) => void) {
    this.#onOpen = onOpen;
    byId("batch-before").addEventListener("click", () => this.#step(-1));
    byId("batch-after").addEventListener("click", () => this.#step(1));
    byId("batch-open").addEventListener("click", () => this.#openList());
    byId("batch-end").addEventListener("click", () => {
      byId<HTMLDialogElement>("batch-list").close();
      this.#keep({ models: [], states: {} });
    });
    this.#state.addEventListener("change", () => this.#mark(this.#state.value as State));
  }

  /** Begin with a list of models, and open the first one that is to do. */
  begin(models: readonly BatchModel[]): void {
    const { states } = this.#kept;
    this.#keep({ models, states: Object.fromEntries(models.flatMap(({ job }) => (states[job] ? [[job, states[job]]] : []))) });
    const first = models.find(({ job }) => this.#stateOf(job) === "todo") ?? models[0];
    if (first !== undefined) this.#onOpen(first.job);
  }

  /** Show where a job is in the list. */
  show(job: string | null): void {
    this.#job = job;
    const { models } = this.#kept;
    const place = models.findIndex((model) => model.job === job);
    byId("batch").hidden = place < 0;
    if (place < 0) return;
    byId("batch-open").textContent = `${place + 1} of ${models.length}`;
    byId("batch-open").title = this.#summary();
    byId<HTMLButtonElement>("batch-before").disabled = place === 0;
    byId<HTMLButtonElement>("batch-after").disabled = place === models.length - 1;
    this.#state.value = this.#stateOf(job!);
  }

  #stateOf(job: string): State {
    return this.#kept.states[job] ?? "todo";
  }

  #mark(state: State): void {
    if (this.#job === null) return;
    this.#keep({ ...this.#kept, states: { ...this.#kept.states, [this.#job]: state } });
  }

  #step(by: 1 | -1): void {
    const { models } = this.#kept;
    const next = models[models.findIndex(({ job }) => job === this.#job) + by];
    if (next !== undefined) this.#onOpen(next.job);
  }

  #openList(): void {
    const dialog = byId<HTMLDialogElement>("batch-list");
    byId("batch-summary").textContent = this.#summary();
    byId("batch-models").replaceChildren(
      ...this.#kept.models.map(({ job, name }) => {
        const open = () => {
          dialog.close();
          this.#onOpen(job);
        };
        const button = h("button", { type: "button", "data-job": job, "aria-current": job === this.#job, onclick: open }, name);
        button.append(h("span", {}, TITLES[this.#stateOf(job)]));
        return h("li", {}, button);
      }),
    );
    openDialog(dialog);
  }

  #summary(): string {
    const count = (state: State) => this.#kept.models.filter(({ job }) => this.#stateOf(job) === state).length;
    return `${plural(this.#kept.models.length, "model")}: ${count("done")} done, ${count("unsure")} unsure, ${count("todo")} to do.`;
  }

  #keep(kept: Kept): void {
    this.#kept = kept;
    keep(KEY, kept);
    this.show(this.#job);
  }
}

function read(): Kept {
  const { models, states } = (stored(KEY) ?? {}) as Partial<Kept>;
  return { models: Array.isArray(models) ? models : [], states: states ?? {} };
}
