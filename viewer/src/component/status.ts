/** The state of the element, and the text that it shows in place of a model. */

import type { ErrorDetail, ViewerState } from "./cleave-viewer";

const LOADING = "Loading the model…";
const COARSE = "A coarse model; the full one follows.";

/** Sets the attribute ``state`` of an element, and the text in its box. */
export class Status {
  readonly box = document.createElement("p");
  error: ErrorDetail | null = null;
  #state: ViewerState = "empty";
  readonly #host: HTMLElement;

  constructor(host: HTMLElement) {
    this.#host = host;
    this.box.part.add("message");
    this.box.hidden = true;
  }

  get state(): ViewerState {
    return this.#state;
  }

  set state(state: ViewerState) {
    this.#set(state, null, state === "loading" ? LOADING : "");
  }

  /** Say below a coarse model that the full one follows. */
  explainCoarse(): void {
    this.box.textContent = COARSE;
    this.box.classList.add("over");
  }

  fail(error: ErrorDetail): void {
    this.#set("failed", error, error.message);
  }

  #set(state: ViewerState, error: ErrorDetail | null, text: string): void {
    this.#state = state;
    this.error = error;
    this.#host.setAttribute("state", state);
    this.box.role = error === null ? "status" : "alert";
    this.box.hidden = text === "";
    this.box.textContent = text;
    this.box.classList.remove("over");
  }
}

/** Return why a server did not send a file: the sentence of its problem document, if there is one. */
export async function reasonOf(answer: Response): Promise<string> {
  const problem = (await answer.json().catch(() => ({}))) as { detail?: unknown };
  if (typeof problem.detail === "string") return problem.detail;
  return `The server responded with status ${answer.status}: check the address of the file.`;
}

/** Return what to do if there is no response. The browser does not say whether the server or its CORS rules are the reason. */
export function unreachable(source: string): string {
  const { origin } = new URL(source, document.baseURI);
  if (origin === location.origin) return "The server is not responding: try again when it runs.";
  return `${origin} is not responding, or does not allow this page: CLEAVE_CORS_ORIGINS there must contain ${location.origin}.`;
}
