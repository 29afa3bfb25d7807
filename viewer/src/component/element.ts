/** The web component ``<cleave-viewer>``, which shows the GLB file of a job. docs/reference/viewer.md describes it. */

import type { CleaveViewer as Declared, CoarseDetail, Color, Colors, ErrorDetail, FaceTable, LoadDetail, Partition, Point, ViewerState } from "./cleave-viewer";
import { coarseModel } from "./coarse";
import { Drawing, type Inks } from "./drawing";
import { faceTable } from "./faces";
import { sphereAround } from "./framing";
import { InvalidModel, parseModel, type Model } from "./glb";
import { sharedEdges } from "./edges";
import { FaceLabels } from "./face_labels";
import { loadOriginal, lookNamed, NoOriginal, type Look } from "./look";
import { segmentName } from "../page/lists.json";
import { partitionModel, type PartitionedModel } from "./partition";
import { Faces } from "./sight";
import { FIRST_VIEW, Stage, type View } from "./stage";
import { reasonOf, Status, unreachable } from "./status";
import { buildSurface, type Surface } from "./surface";
import type { Cut, PartTree } from "./tree";

export type { CoarseDetail, Color, Colors, FaceTable, LoadDetail, Look, Model, Partition, Point, View };
export { nodeOfPart } from "./partition";
export type { Faces } from "./sight";
export { type Cut, type PartTree, type TreeNode } from "./tree";

const LIGHT: Inks = {
  line: [0.09, 0.1, 0.13, 0.62],
  selected: [0.27, 0.25, 0.72, 1],
  concave: [0.78, 0.09, 0.16, 0.95],
  mark: [0.78, 0.09, 0.16, 0.85],
  wire: [0.05, 0.06, 0.09, 0.2],
  sky: [0.93, 0.93, 0.95],
};
const DARK: Inks = {
  line: [0.04, 0.04, 0.06, 0.75],
  selected: [1, 1, 1, 1],
  concave: [1, 0.36, 0.36, 1],
  mark: [1, 0.36, 0.36, 0.85],
  wire: [0.02, 0.02, 0.03, 0.32],
  sky: [0.16, 0.17, 0.2],
};
const STYLE = `
:host { display: block; position: relative; min-width: 1px; min-height: 1px; contain: strict; contain-intrinsic-block-size: 20rem; }
:host([hidden]) { display: none; }
canvas { display: block; width: 100%; height: 100%; touch-action: none; outline: none; cursor: grab; border-radius: inherit; }
canvas:active { cursor: grabbing; }
canvas.over { cursor: pointer; }
p { position: absolute; inset: 0; display: grid; place-content: center; margin: 0; padding: 1em; text-align: center; pointer-events: none; }
p[hidden] { display: none; }
:host([state="failed"]) canvas { visibility: hidden; }
:host([state="loading"]) p.over { inset: auto 0 0; }
:host([state="loading"]) p { animation: wait 0s 0.3s both; }
@keyframes wait { from { visibility: hidden; } }
canvas:focus-visible { box-shadow: inset 0 0 0 3px var(--cleave-focus, #5b5bd6); }
`;
const NO_COLORS: Colors = new Map();
const CLICK_PIXELS = 5; // a pointer that moves farther drags
/** Models of more faces are shown coarse first: the processor draws so many in about half a second. */
const COARSE_FROM = 200_000;
const PAUSE_MS = 12; // of work on a model before control returns to the event loop

/** The server did not send the model; the message says why. */
class NotLoaded extends Error {}

/** Servers that render pages import the module as well, but have no elements. */
const Element = globalThis.HTMLElement ?? (class {} as typeof HTMLElement);

export class CleaveViewer extends Element implements Declared {
  static readonly observedAttributes = [
    "src",
    "segments",
    "selected",
    "explode",
    "wireframe",
    "concavity",
    "no-lines",
    "up",
    "look",
    "theme",
    "label",
  ];

  /** Whether clicks select parts, and the part under the pointer is highlighted. */
  selects = true;
  #isDimming = true;

  /** Headers of the request for ``src``. */
  requestHeaders: Record<string, string> = {};

  readonly #status = new Status(this);
  #canvas = document.createElement("canvas");
  #stage: Stage | null = null;
  #resizing: ResizeObserver | null = null;
  #model: Model | null = null;
  #surface: Surface | null = null;
  #drawing: Drawing | null = null;
  #colors: Colors = new Map();
  #sight: Faces | null = null;
  #edges: Int32Array | null = null;
  #labels: FaceLabels | null = null;
  /** The tree of the parts of a partition, which replaces that of the model. */
  #partitioned: PartitionedModel | null = null;
  /** The cut that was shown before the partition. */
  #cutBefore: Cut = new Set();
  #placed = "";
  #loading: AbortController | null = null;
  #loadingLook: AbortController | null = null;
  #cut: Cut = new Set();
  #hidden: ReadonlySet<number> = new Set();
  #selected: readonly number[] = [];
  #hovered = -1;
  #names: ReadonlyMap<number, string> = new Map();
  #firstView: View | null = null;
  #pressed: { x: number; y: number } | null = null;
  #hoverFrame = 0;
  readonly #dark: MediaQueryList = matchMedia("(prefers-color-scheme: dark)");

  constructor() {
    super();
    const root = this.attachShadow({ mode: "open", delegatesFocus: true });
    const style = new CSSStyleSheet();
    style.replaceSync(STYLE);
    root.adoptedStyleSheets = [style];
  }

  connectedCallback(): void {
    this.#canvas = this.#newCanvas(); // a canvas cannot be used after its WebGL context was released
    this.shadowRoot!.replaceChildren(this.#canvas, this.#status.box);
    this.#status.state = "empty";
    try {
      this.#stage = new Stage(this.#canvas, () => this.#emit("cleave-view", this.view));
    } catch {
      this.#fail("no_webgl", "This browser shows no 3D graphics: enable WebGL 2 (hardware acceleration), or use another browser.");
      return;
    }
    this.#resizing = new ResizeObserver(() => this.#stage?.resize());
    this.#resizing.observe(this);
    this.#dark.addEventListener("change", this.#applyTheme);
    this.#describe();
    const source = this.getAttribute("src");
    if (source !== null && this.#model === null) void this.#fetch(source);
  }

  disconnectedCallback(): void {
    cancelAnimationFrame(this.#hoverFrame);
    this.#dark.removeEventListener("change", this.#applyTheme);
    this.#resizing?.disconnect();
    this.clear();
    this.#stage?.dispose();
    this.#stage = null;
  }

  attributeChangedCallback(name: string, before: string | null, value: string | null): void {
    if (before === value) return;
    if (name === "src") {
      if (this.#stage === null) return;
      if (value === null) this.clear();
      else void this.#fetch(value);
    } else if (name === "segments") {
      if (this.#model !== null) this.cut = this.#model.tree.cutAt(Number(value));
    } else if (name === "selected") {
      this.selected = (value ?? "").split(/[\s,]+/).flatMap((id) => (id === "" ? [] : [Number(id)]));
    } else if (name === "theme") {
      this.#applyTheme();
    } else if (name === "label") {
      this.#describe();
    } else if (name === "look") {
      void this.#applyLook();
    } else {
      this.#applyModes();
    }
  }

  get state(): ViewerState {
    return this.#status.state;
  }

  /** Why the state is ``failed``; null in other states. */
  get error(): ErrorDetail | null {
    return this.#status.error;
  }

  /** The tree of cuts of the present model; null if no model is shown. */
  get tree(): PartTree | null {
    return this.#partitioned?.tree ?? this.#model?.tree ?? null;
  }

  /** The faces of the file as they are seen; null if no model is shown, or if its faces have no numbers. */
  get sight(): Faces | null {
    const [model, surface, stage] = [this.#model, this.#surface, this.#stage];
    if (model === null || surface === null || stage === null || model.inputFaces === null) return null;
    return (this.#sight ??= new Faces(model, model.inputFaces, this.#sharedEdges(surface), stage));
  }

  /**
   * Show any labels of the faces as parts; null shows the parts of the cut again. The parts are then the leaves of a tree
   * of one step, see nodeOfPart.
   */
  set partition(partition: Partition | null) {
    const [model, drawing] = [this.#model, this.#drawing];
    if (model === null || drawing === null || model.inputFaces === null) return;
    if (partition === null && this.#partitioned !== null) this.#cut = this.#cutBefore;
    else if (this.#partitioned === null) this.#cutBefore = this.#cut;
    if ((partition === null) !== (this.#partitioned === null)) [this.#hidden, this.#selected] = [new Set(), []];
    this.#partitioned = partition === null ? null : partitionModel(model, model.inputFaces, partition);
    this.#hovered = -1;
    if (partition === null) {
      drawing.showLeaves();
    } else {
      this.#labels ??= new FaceLabels(model.inputFaces.length);
      this.#labels.fill(partition.labels, model.inputFaces);
      drawing.showPartition(this.#partitioned!, this.#labels, this.#sharedEdges(this.#surface!));
      this.#cut = this.#partitioned!.tree.cutAt(Infinity);
    }
    this.#placed = "";
    this.#updateLeaves();
  }

  #sharedEdges(surface: Surface): Int32Array {
    return (this.#edges ??= sharedEdges(surface.welded));
  }

  /** Return for each face of the file the place of its part among the parts of the cut; null without numbers of faces. */
  labelsOfCut(cut: Cut): Int32Array | null {
    const model = this.#model;
    if (model === null || model.inputFaces === null) return null;
    const { tree, leafNodes, leafStart, inputFaces } = model;
    const place = new Map(tree.parts(cut).map((id, number) => [id, number]));
    const labels = new Int32Array(inputFaces.length);
    leafNodes.forEach((node, leaf) => {
      const number = place.get(tree.partOf(cut, node))!;
      for (let drawn = leafStart[leaf]!; drawn < leafStart[leaf + 1]!; drawn++) labels[inputFaces[drawn]!] = number;
    });
    return labels;
  }

  /** Show some faces in another part of the partition until the next partition is set. */
  paint(faces: readonly number[], part: number): void {
    if (this.#partitioned === null || this.sight === null) return;
    this.#labels?.paint(this.sight.drawn(faces), part);
    this.#stage?.repaint();
  }

  /** Whether parts are grey while others are selected. */
  set isDimming(isDimming: boolean) {
    if (isDimming === this.#isDimming) return;
    this.#isDimming = isDimming;
    this.#updateLeaves();
  }

  /** Whether the main button and one finger belong to a tool that draws; the other ones then turn the model. */
  set isDrawing(isDrawing: boolean) {
    if (this.#stage !== null) this.#stage.isDrawing = isDrawing;
  }

  get automaticSegments(): number {
    return this.#model?.automaticSegments ?? 1;
  }

  /** The nodes that are split; the parts are the nodes just below. */
  get cut(): Cut {
    return this.#cut;
  }

  set cut(cut: Cut) {
    this.#cut = cut;
    this.#updateLeaves();
  }

  get parts(): number[] {
    return this.tree?.parts(this.#cut) ?? [];
  }

  get hiddenParts(): ReadonlySet<number> {
    return this.#hidden;
  }

  set hiddenParts(parts: ReadonlySet<number>) {
    this.#hidden = parts;
    this.#updateLeaves();
  }

  get selected(): readonly number[] {
    return this.#selected;
  }

  set selected(parts: readonly number[]) {
    this.#selected = parts;
    this.#updateLeaves();
  }

  /** The highlighted part; -1 for none. */
  get hovered(): number {
    return this.#hovered;
  }

  set hovered(part: number) {
    if (part === this.#hovered) return;
    this.#hovered = part;
    this.#updateLeaves();
  }

  /** Colours of nodes that have others than those of their labels; sRGB, 0..1. */
  set colors(colors: Colors) {
    this.#colors = colors;
    this.#updateLeaves();
  }

  /** The faces in the order of the model; null if no model is shown. */
  get faces(): FaceTable | null {
    return this.#model === null ? null : faceTable(this.#model);
  }

  /** Cover some faces, numbered as in the model, with a colour; null for none. */
  set marked(faces: Uint32Array | null) {
    if (this.#drawing !== null) this.#drawing.marked = faces;
    this.#stage?.changed();
  }

  /** Names of nodes for the text alternative. */
  set names(names: ReadonlyMap<number, string>) {
    this.#names = names;
    this.#describe();
  }

  get view(): View {
    return this.#stage?.view ?? FIRST_VIEW;
  }

  /** The camera. If it is set before a model is loaded, the model appears without an entrance. */
  set view(view: View) {
    if (this.#model === null) this.#firstView = view;
    if (this.#stage !== null) this.#stage.view = view;
  }

  /** Return to the first view of the whole model. */
  resetView(): void {
    this.view = FIRST_VIEW;
  }

  /** Move the camera so that some parts fill the view. */
  focusOn(parts: readonly number[]): void {
    const [model, surface, drawing, stage] = [this.#model, this.#surface, this.#drawing, this.#stage];
    if (model === null || surface === null || drawing === null || stage === null) return;
    const { leafNodes, tree } = this.#partitioned ?? model;
    const inside = leafNodes.flatMap((node, leaf) => (parts.includes(tree.partOf(this.#cut, node)) ? [leaf] : []));
    const sphere = sphereAround(drawing, surface, new Set(inside), this.#partitioned === null ? null : this.#labels!.parts);
    if (sphere === null) return;
    stage.glideTo({ ...stage.view, distance: FIRST_VIEW.distance * sphere.radius, target: sphere.center.toArray() });
  }

  /** Return the colour of a node as a CSS colour. */
  colorOf(node: number): string {
    return `rgb(${this.shadeOf(node).map((channel) => Math.round(255 * channel)).join(" ")})`;
  }

  /** Return the colour of a node; sRGB, 0..1. */
  shadeOf(node: number): Color {
    const model = this.#partitioned ?? this.#model;
    return this.#colors.get(node) ?? model?.palette[model.tree.node(node).label % model.palette.length] ?? [0.6, 0.6, 0.6];
  }

  /** Return the part at a position in the window; -1 if there is none. */
  partAt(clientX: number, clientY: number): number {
    if (this.#model === null) return -1; // what is drawn is coarse, if anything
    const box = this.#canvas.getBoundingClientRect();
    const id = this.#stage?.idAt(clientX - box.left, clientY - box.top) ?? -1;
    const leaf = id < 0 || this.#partitioned === null ? id : this.#labels!.parts[id]!;
    return leaf < 0 ? -1 : (this.#drawing?.appearance.partOfLeaf[leaf] ?? -1);
  }

  /** Return a PNG of the present view, without a background. */
  picture(): Promise<Blob> {
    if (this.#stage === null) return Promise.reject(new Error("Nothing is shown."));
    return this.#stage.picture();
  }

  /** Figures for benchmarks. ``frame`` draws one frame and waits for the GPU. */
  readonly figures = {
    frame: (): void => this.#stage?.finish(),
    drawCalls: (): number => this.#stage?.drawCalls ?? 0,
    memory: () => this.#stage?.memory ?? { geometries: 0, textures: 0 },
  };

  /** Show the bytes of a GLB file. */
  async load(data: ArrayBuffer): Promise<void> {
    await this.#loadFrom(null, async () => data);
  }

  /** Remove the model and free its memory. */
  clear(): void {
    this.#loading?.abort();
    this.#remove();
    if (this.#stage !== null) this.#status.state = "empty";
  }

  #remove(): void {
    this.#loadingLook?.abort();
    this.#drawing?.dispose();
    this.#drawing = null;
    this.#labels?.dispose();
    this.#model = this.#surface = this.#edges = this.#sight = this.#labels = this.#partitioned = null;
    this.#colors = new Map();
    this.#hovered = -1;
    this.#stage?.show(null);
    this.#describe();
  }

  async #fetch(source: string): Promise<void> {
    await this.#loadFrom(source, async (signal) => {
      const noResponse = (): never => {
        throw new NotLoaded(unreachable(source));
      };
      const answer = await fetch(source, { headers: this.requestHeaders, signal }).catch(noResponse);
      if (!answer.ok) throw new NotLoaded(await reasonOf(answer));
      return answer.arrayBuffer().catch(noResponse);
    });
  }

  async #loadFrom(src: string | null, read: (signal: AbortSignal) => Promise<ArrayBuffer>): Promise<void> {
    if (this.#stage === null) return;
    this.#loading?.abort();
    const { signal } = (this.#loading = new AbortController());
    this.#status.state = "loading";
    this.#emit("cleave-loading", { src });
    try {
      await this.#show(await read(signal), signal);
    } catch (error) {
      if (signal.aborted) return;
      if (error instanceof InvalidModel) this.#fail("invalid_model", error.message);
      else if (error instanceof NotLoaded) this.#fail("not_loaded", `The model was not loaded. ${error.message}`);
      else throw error;
    }
  }

  async #show(data: ArrayBuffer, signal: AbortSignal): Promise<void> {
    const model = parseModel(data);
    const faces = model.index.length / 3;
    const isCoarseFirst = faces > Number(this.getAttribute("coarse-from") ?? COARSE_FROM);
    if (isCoarseFirst) await this.#showCoarse(model, signal);
    const surface = await buildSurface(model, eventLoopYielder());
    if (signal.aborted || this.#stage === null) return;
    const view = isCoarseFirst ? this.view : null; // to which it was turned meanwhile
    this.#remove();
    this.#model = model;
    this.#surface = surface;
    this.#draw(new Drawing(model, surface, this.#inks()), model, view);
    void this.#applyLook();
    const detail = {
      maxSegments: model.tree.maxSegments,
      automaticSegments: model.automaticSegments,
      limitReached: model.limitReached,
      faces,
    };
    this.#status.state = "loaded";
    this.#emit("cleave-load", detail satisfies LoadDetail);
    if (!isCoarseFirst && this.#firstView === null && !this.hasAttribute("no-entrance")) this.#stage.enter();
    this.#firstView = null;
  }

  /** Show a coarse model until the full one is drawn; nothing can be picked on it. */
  async #showCoarse(model: Model, signal: AbortSignal): Promise<void> {
    const coarse = coarseModel(model);
    const surface = await buildSurface(coarse, eventLoopYielder());
    if (signal.aborted || this.#stage === null) return;
    this.#remove();
    this.#draw(new Drawing(coarse, surface, this.#inks()), coarse, null);
    const detail = { faces: coarse.index.length / 3, fullFaces: model.index.length / 3 };
    this.#status.explainCoarse();
    this.#emit("cleave-coarse", detail satisfies CoarseDetail);
    await shown();
  }

  /** Show the first cut of a model in a view, by default the first one. */
  #draw(drawing: Drawing, { tree, automaticSegments }: Model, view: View | null): void {
    this.#drawing = drawing;
    this.#cut = tree.cutAt(Number(this.getAttribute("segments") ?? automaticSegments));
    this.#hidden = new Set();
    this.#selected = [];
    this.#stage!.view = view ?? this.#firstView ?? FIRST_VIEW;
    this.#stage!.show(drawing);
    this.#applyModes();
  }

  #applyModes(): void {
    const drawing = this.#drawing;
    if (drawing === null || this.#stage === null) return;
    drawing.borders = !this.hasAttribute("no-lines");
    drawing.wireframe = this.hasAttribute("wireframe");
    drawing.concavity = this.hasAttribute("concavity");
    this.#stage.isZUp = this.getAttribute("up") === "z";
    this.#updateLeaves();
  }

  /** Show the look of the attribute; the original is loaded when it is needed first. */
  async #applyLook(): Promise<void> {
    const [drawing, model, stage] = [this.#drawing, this.#model, this.#stage];
    if (drawing === null || model === null || stage === null) return;
    const look = lookNamed(this.getAttribute("look"));
    this.#loadingLook?.abort();
    if (look !== "parts" && drawing.original === null) {
      const loading = (this.#loadingLook = new AbortController());
      try {
        const [source, { signal }] = [this.getAttribute("original-src"), loading];
        const original = await loadOriginal(source, this.requestHeaders, model, signal, eventLoopYielder());
        if (loading.signal.aborted || this.#drawing !== drawing) return original.dispose();
        stage.light(original.surroundings);
        drawing.original = original;
      } catch (error) {
        if (loading.signal.aborted) return;
        if (!(error instanceof NoOriginal)) throw error;
        this.#emit("cleave-look-error", { message: error.message });
        return;
      }
    }
    drawing.look = look;
    this.#updateLeaves();
    this.#emit("cleave-look", { look });
  }

  #updateLeaves(): void {
    if (this.#drawing === null || this.#stage === null) return;
    const explode = Math.min(Math.max(Number(this.getAttribute("explode") ?? 0), 0), 1);
    const { appearance } = this.#drawing;
    appearance.show({
      cut: this.#cut,
      hidden: this.#hidden,
      selected: this.#selected,
      hovered: this.#hovered,
      colors: this.#partitioned === null ? this.#colors : NO_COLORS,
      isDimmed: this.#isDimming,
      explode,
    });
    this.#drawing.explode = explode;
    this.#drawing.update();
    this.#stage.reach = 1 + explode;
    const placed = [explode, ...this.#hidden].join();
    if (this.#partitioned !== null && placed === this.#placed) this.#stage.repaint();
    else this.#stage.changed();
    this.#placed = placed;
    this.#describe();
  }

  readonly #applyTheme = (): void => {
    this.#drawing?.applyInks(this.#inks());
    this.#stage?.changed();
  };

  #inks(): Inks {
    const theme = this.getAttribute("theme");
    return theme === "dark" || (theme !== "light" && this.#dark.matches) ? DARK : LIGHT;
  }

  /** Update the text alternative. */
  #describe(): void {
    const label = this.getAttribute("label");
    if (this.#model === null) {
      this.#canvas.setAttribute("aria-label", label ?? "No model");
      return;
    }
    const tree = this.tree!;
    const parts = this.parts;
    const shown = parts.toSorted((a, b) => tree.node(b).area - tree.node(a).area).slice(0, 12);
    const nameOf = (id: number) => this.#names.get(id) ?? `${segmentName} ${parts.indexOf(id)}`;
    const list = shown.map((id) => `${nameOf(id)} ${percent(tree.node(id).area / tree.totalArea)}`).join(", ");
    const rest = parts.length > shown.length ? `, and ${parts.length - shown.length} smaller ones` : "";
    const title = label === null ? "" : `${label}: `;
    this.#canvas.setAttribute("aria-label", `${title}${parts.length} ${parts.length === 1 ? "part" : "parts"}. ${list}${rest}.`);
  }

  #newCanvas(): HTMLCanvasElement {
    const canvas = document.createElement("canvas");
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-roledescription", "3D view");
    canvas.addEventListener("pointermove", (event) => this.#hover(event));
    canvas.addEventListener("pointerleave", () => this.#leave());
    canvas.addEventListener("pointerdown", (event) => (this.#pressed = { x: event.clientX, y: event.clientY }));
    canvas.addEventListener("pointerup", (event) => this.#click(event));
    canvas.addEventListener("keydown", (event) => this.#key(event));
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => this.#updateLeaves());
    return canvas;
  }

  #hover(event: PointerEvent): void {
    if (!this.selects || event.pointerType === "touch" || event.buttons !== 0 || this.#hoverFrame !== 0) return;
    this.#hoverFrame = requestAnimationFrame(() => {
      this.#hoverFrame = 0;
      this.#setHovered(this.partAt(event.clientX, event.clientY));
    });
  }

  /** Hover no part, and drop the part of a move whose frame is still to come. */
  #leave(): void {
    cancelAnimationFrame(this.#hoverFrame);
    this.#hoverFrame = 0;
    this.#setHovered(-1);
  }

  #setHovered(part: number): void {
    if (part === this.#hovered) return;
    this.hovered = part;
    this.#canvas.classList.toggle("over", part >= 0);
    this.#emit("cleave-hover", { part });
  }

  #click(event: PointerEvent): void {
    const from = this.#pressed;
    this.#pressed = null;
    if (from === null || event.button !== 0 || !this.selects) return;
    if (Math.hypot(event.clientX - from.x, event.clientY - from.y) > CLICK_PIXELS) return;
    const isMore = event.shiftKey || event.ctrlKey || event.metaKey;
    this.#pick(this.partAt(event.clientX, event.clientY), isMore);
  }

  /** Select a part, or toggle it in the selection; listeners may refuse with ``preventDefault``. */
  #pick(part: number, isMore: boolean): void {
    const chosen = part < 0 ? [] : [part];
    const rest = this.#selected.filter((other) => other !== part);
    const selected = !isMore ? chosen : rest.length < this.#selected.length ? rest : [...this.#selected, ...chosen];
    if (this.#emit("cleave-select", { parts: selected })) this.selected = selected;
  }

  #key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const stage = this.#stage;
    const actions: Record<string, () => void> = {
      ArrowLeft: () => stage?.turn(-1, 0),
      ArrowRight: () => stage?.turn(1, 0),
      ArrowUp: () => stage?.turn(0, -1),
      ArrowDown: () => stage?.turn(0, 1),
      "+": () => stage?.zoom(0.88),
      "=": () => stage?.zoom(0.88),
      "-": () => stage?.zoom(1 / 0.88),
      0: () => this.resetView(),
      "]": () => this.#pickNext(1),
      "[": () => this.#pickNext(-1),
      Escape: () => this.#pick(-1, false),
    };
    const action = actions[event.key];
    if (action === undefined || this.#model === null) return;
    event.preventDefault();
    event.stopPropagation();
    action();
  }

  #pickNext(step: number): void {
    const parts = this.parts.filter((part) => !this.#hidden.has(part));
    if (parts.length === 0) return;
    const now = parts.indexOf(this.#selected.at(-1) ?? -1);
    this.#pick(parts.at(now < 0 && step > 0 ? 0 : (now + step) % parts.length)!, false);
  }

  #fail(code: ErrorDetail["code"], message: string): void {
    this.#remove();
    this.#status.fail({ code, message });
    this.#emit("cleave-error", { code, message });
  }

  #emit(name: string, detail: object): boolean {
    return this.dispatchEvent(new CustomEvent(name, { detail, cancelable: true, bubbles: true, composed: true }));
  }
}

function percent(share: number): string {
  return new Intl.NumberFormat("en", { style: "percent", maximumSignificantDigits: 2 }).format(share);
}

/** Wait until the browser has shown a frame; it shows none of a page in the background. */
function shown(): Promise<void> {
  return new Promise((resolve) => {
    if (document.hidden) resolve();
    else requestAnimationFrame(() => setTimeout(resolve));
  });
}

/** Return a function that yields to the event loop if PAUSE_MS have passed since the last time. */
function eventLoopYielder(): () => Promise<void> {
  let since = performance.now();
  return async () => {
    if (performance.now() - since < PAUSE_MS) return;
    await new Promise((resolve) => setTimeout(resolve));
    since = performance.now();
  };
}

// The package and the file of a service may be on one page; the first one that is loaded defines the element.
if (globalThis.customElements?.get("cleave-viewer") === undefined) globalThis.customElements?.define("cleave-viewer", CleaveViewer);
