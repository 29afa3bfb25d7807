/** The row of tools, the controls of the chosen one, and their keys. */

import type { CleaveViewer } from "../../component/element";
import { announce, byId } from "../dom";
import type { Session } from "../session";
import { BorderTool } from "./border";
import { Brush } from "./brush";
import { CutTool } from "./cut";
import type { Editor } from "./editor";
import { Gestures } from "./gestures";
import { Lasso } from "./lasso";
import { Overlay } from "./overlay";
import { PartTool } from "./part_tool";
import type { Desk, Tool } from "./tool";

const KEYS: Readonly<Record<string, string>> = { v: "select", p: "part", b: "brush", e: "lasso", k: "cut", d: "border" };

export class Toolbox {
  readonly #viewer: CleaveViewer;
  readonly #editor: Editor;
  readonly #session: () => Session | null;
  readonly #overlay: Overlay;
  readonly #gestures: Gestures;
  readonly #tools: ReadonlyMap<string, Tool>;
  /** Null while clicks select parts. */
  #tool: Tool | null = null;

  constructor(viewer: CleaveViewer, editor: Editor, session: () => Session | null) {
    this.#viewer = viewer;
    this.#editor = editor;
    this.#session = session;
    this.#overlay = new Overlay(viewer);
    const desk: Desk = { viewer, editor, overlay: this.#overlay, session };
    const tools = [new PartTool(desk), new Brush(desk), new Lasso(desk), new CutTool(desk), new BorderTool(desk)];
    this.#tools = new Map(tools.map((tool) => [tool.id, tool]));
    this.#gestures = new Gestures(viewer, this.#overlay, () => this.#tool);
    byId("edit-tools").addEventListener("click", (event) => {
      const button = (event.target as Element).closest<HTMLElement>("[data-tool]");
      if (button !== null) this.choose(button.dataset["tool"]!);
    });
    viewer.addEventListener("keydown", (event) => this.#key(event), { capture: true });
  }

  /** Choose a tool by its id; ``select`` selects parts with clicks. */
  choose(id: string): void {
    if (this.#tool?.drop() !== true && this.#editor.isPreview) this.#editor.drop();
    this.#gestures.rest();
    const tool = this.#tools.get(id) ?? null;
    if (tool !== null && (this.#session() === null || !this.#editor.begin())) return;
    this.#tool = tool;
    this.#overlay.clear();
    this.#viewer.selects = tool === null;
    this.#viewer.isDimming = tool?.draws !== "strokes";
    this.#viewer.isDrawing = tool?.draws === "strokes";
    if (tool === null) this.#editor.end();
    else if ((this.#session()?.modes.explode ?? 0) > 0) this.#session()?.setModes({ explode: 0 });
    for (const button of byId("edit-tools").querySelectorAll<HTMLElement>("[data-tool]"))
      button.setAttribute("aria-pressed", String(button.dataset["tool"] === (tool?.id ?? "select")));
    byId("tool-bar").hidden = tool === null;
    byId("tool-hint").textContent = tool?.hint ?? "";
    byId("tool-options").replaceChildren(...(tool?.options ?? []));
    document.body.classList.toggle("has-tool", tool !== null);
    tool?.update();
    const name = byId("edit-tools").querySelector(`[data-tool="${tool?.id ?? "select"}"]`)?.getAttribute("aria-label") ?? "";
    byId("tool-bar").setAttribute("aria-label", name);
    announce(`${name}. ${tool?.hint ?? "Click a part to select it."}`);
  }

  /** Update the controls after the parts or the selection have changed. */
  update(): void {
    this.#tool?.update();
  }

  /** Return to selecting, for another job. */
  reset(): void {
    if (this.#tool !== null) this.choose("select");
  }

  #key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === "Escape" && this.#tool !== null) {
      if (!this.#gestures.cancel() && !this.#tool.drop()) this.choose("select");
    } else {
      const id = KEYS[event.key];
      if (id === undefined || this.#session() === null) return;
      this.choose(id);
    }
    event.preventDefault();
    event.stopPropagation();
  }
}
