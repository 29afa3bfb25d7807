/** Types of the web component `<cleave-viewer>`: attributes, properties and events. */

/** What is drawn: a colour for each part, the colours and textures of the file, or both. */
export type Look = "parts" | "original" | "both";

/** `empty` without `src`; `failed` if the model cannot be shown, until another is. */
export type ViewerState = "empty" | "loading" | "loaded" | "failed";

/** Camera position: angles in radians; distance and target in radii of the model. */
export interface View {
  readonly azimuth: number;
  readonly polar: number;
  readonly distance: number;
  readonly target: readonly [number, number, number];
}

/** A node of the tree; node 0 is the whole mesh, and split s makes the nodes 2 s + 1 and 2 s + 2. */
export interface TreeNode {
  readonly id: number;
  /** -1 for the whole mesh. */
  readonly parent: number;
  /** Two, the larger first, or none. */
  readonly children: readonly number[];
  /** The smallest number of segments at which the node is a segment. */
  readonly level: number;
  /** Its label at every level at which it is a segment; selects its colour. */
  readonly label: number;
  /** In squared units of the mesh. */
  readonly area: number;
  readonly faces: number;
  /** Value of the cut that splits the node; null for a leaf. */
  readonly cutValue: number | null;
  /** Step of the cut that splits the node; null for a leaf. Cuts that separate equal parts have one step. */
  readonly step: number | null;
}

/** The set of nodes that are split; it contains the parents of its nodes. The parts are the nodes just below. */
export type Cut = ReadonlySet<number>;

/** sRGB, 0..1. */
export type Color = readonly [number, number, number];

/** Colours by node. */
export type Colors = ReadonlyMap<number, Color>;

/** The faces of a model in the order in which it stores them. */
export interface FaceTable {
  /** (L) tree node of every leaf. */
  readonly leafNodes: readonly number[];
  /** (L + 1) leaf i has the faces leafStart[i] to leafStart[i + 1] - 1, in the order of the input. */
  readonly leafStart: readonly number[];
  /** (F) area of every face. */
  readonly areas: Float32Array;
}

/** The tree of cuts. */
export interface Tree {
  readonly nodes: readonly TreeNode[];
  readonly maxSegments: number;
  readonly totalArea: number;
  /** Entry i: value of the cut from i + 1 to i + 2 segments. */
  readonly cutValues: readonly (number | null)[];
  /** The numbers of segments that are worth offering: 1, and those after the last split of each step. */
  readonly stepEnds: readonly number[];
  node(id: number): TreeNode;
  /** Return the cut with a number of segments, clipped to 1..maxSegments. */
  cutAt(segments: number): Cut;
  /** Return the cut with the given splits and the splits above them. */
  cutOfSplits(splits: Iterable<number>): Cut;
  /** Return the splits of a cut in ascending order, as in `?splits=` of the API. */
  splitsOf(cut: Cut): number[];
  /** Return the number of segments of a cut; null if it is not a level of the tree. */
  levelOf(cut: Cut): number | null;
  /** Return the parts of a cut, sorted by label. */
  parts(cut: Cut): number[];
  /** Return the nodes that are shown below a node of a cut in the n-ary tree, sorted by label. */
  childrenIn(cut: Cut, id: number): number[];
  /** Return the part that contains a node; -1 if the node itself is split. */
  partOf(cut: Cut, id: number): number;
  /** Return the cut with one more part split, together with the parts below it that belong to the step. */
  split(cut: Cut, part: number): Cut;
  /** Return the cut with all parts below a node merged. */
  merge(cut: Cut, id: number): Cut;
}

/** Labels of the faces of the file. */
export interface Partition {
  /** (F) the part of each face, 0..K - 1. */
  readonly labels: Int32Array;
  /** (K) CSS colours #rrggbb. */
  readonly colors: readonly string[];
}

/** A position on the element, in CSS pixels. */
export type Point = readonly [x: number, y: number];

/** The faces that are seen while a partition is shown, by their numbers in the file. */
export interface Sight {
  /** Return the face at a position; -1 if there is none. */
  at(point: Point): number;
  /** Return the visible faces in the discs around the points of a path. */
  alongPath(path: readonly Point[], radius: number): number[];
  /** Return a function that returns the visible faces in discs, those that it has not returned before. */
  stroke(radius: number): (path: readonly Point[]) => number[];
  /** Return the visible faces in a closed outline. */
  inOutline(outline: readonly Point[]): number[];
  /** Return where the middle of a face is; null if it is behind the camera. */
  place(face: number): Point | null;
}

/** Detail of `cleave-load`. */
export interface LoadDetail {
  readonly maxSegments: number;
  readonly automaticSegments: number;
  /** Null if it is not known. */
  readonly limitReached: boolean | null;
  readonly faces: number;
}

/** Detail of `cleave-coarse`. */
export interface CoarseDetail {
  /** Of the coarse model. */
  readonly faces: number;
  readonly fullFaces: number;
}

/** Detail of `cleave-error`, and the property `error`. */
export interface ErrorDetail {
  readonly code: "no_webgl" | "not_loaded" | "invalid_model";
  /** A sentence for people, which says what to do. */
  readonly message: string;
}

/** Events by name. All of them bubble out of shadow roots. */
export interface CleaveViewerEventMap {
  "cleave-loading": CustomEvent<{ readonly src: string | null }>;
  /** A coarse model is shown, until `cleave-load` reports the full one. */
  "cleave-coarse": CustomEvent<CoarseDetail>;
  "cleave-load": CustomEvent<LoadDetail>;
  "cleave-error": CustomEvent<ErrorDetail>;
  "cleave-look": CustomEvent<{ readonly look: Look }>;
  "cleave-look-error": CustomEvent<{ readonly message: string }>;
  /** `part` is -1 for none. */
  "cleave-hover": CustomEvent<{ readonly part: number }>;
  /** `preventDefault()` keeps the present selection. */
  "cleave-select": CustomEvent<{ readonly parts: readonly number[] }>;
  "cleave-view": CustomEvent<View>;
}

/** Attributes, for JSX and templates. */
export interface CleaveViewerAttributes {
  src?: string;
  segments?: number | string;
  /** Nodes, separated by blanks. */
  selected?: string;
  /** 0 to 1. */
  explode?: number | string;
  wireframe?: boolean | "";
  concavity?: boolean | "";
  "no-lines"?: boolean | "";
  "no-entrance"?: boolean | "";
  /** By default 200000. */
  "coarse-from"?: number | string;
  up?: "y" | "z";
  look?: Look;
  "original-src"?: string;
  theme?: "light" | "dark";
  label?: string;
}

export declare class CleaveViewer extends HTMLElement {
  /** Headers of the requests for `src` and `original-src`. */
  requestHeaders: Record<string, string>;
  readonly state: ViewerState;
  /** Why the state is `failed`; null in other states. */
  readonly error: ErrorDetail | null;
  /** Null if no model is shown. */
  readonly tree: Tree | null;
  readonly automaticSegments: number;
  /** The nodes that are split. */
  cut: Cut;
  /** The parts of the present cut, sorted by label. */
  readonly parts: number[];
  hiddenParts: ReadonlySet<number>;
  selected: readonly number[];
  /** The highlighted part; -1 for none. */
  hovered: number;
  /** Names of nodes for the text alternative. */
  set names(names: ReadonlyMap<number, string>);
  /** The camera. If it is set before a model is loaded, the model appears without an entrance. */
  view: View;
  resetView(): void;
  /** Move the camera so that some parts fill the view. */
  focusOn(parts: readonly number[]): void;
  /** Return the colour of a node as a CSS colour. */
  colorOf(node: number): string;
  /** Return the colour of a node. */
  shadeOf(node: number): Color;
  /** Colours of nodes that have others than those of their labels. */
  set colors(colors: Colors);
  /** Null if no model is shown. */
  readonly faces: FaceTable | null;
  /** Cover some faces, numbered as in the model, with a colour; null for none. */
  set marked(faces: Uint32Array | null);
  /** Show any labels of the faces of the file as parts, the leaves of a tree of one step; null shows those of the cut. */
  set partition(partition: Partition | null);
  /** Show some faces of the file in another part of the partition, until the next one is set. */
  paint(faces: readonly number[], part: number): void;
  /** Return the part of each face of the file, as its place among the parts of a cut; null for files of earlier versions. */
  labelsOfCut(cut: Cut): Int32Array | null;
  /** The faces of a partition as they are seen; null if no model is shown. */
  readonly sight: Sight | null;
  /** Whether clicks select parts, and the part under the pointer is highlighted. */
  selects: boolean;
  /** Whether the main button and one finger are left to a tool; the others then turn the model. */
  set isDrawing(isDrawing: boolean);
  /** Whether parts are grey while others are selected. */
  set isDimming(isDimming: boolean);
  /** Return the part at a position in the window; -1 if there is none. */
  partAt(clientX: number, clientY: number): number;
  /** Return a PNG of the present view, without a background. */
  picture(): Promise<Blob>;
  /** Show the bytes of a GLB file. Bytes that are none are the state `failed` and the event `cleave-error`. */
  load(data: ArrayBuffer): Promise<void>;
  /** Remove the model and free its memory. */
  clear(): void;

  addEventListener<K extends keyof CleaveViewerEventMap>(
    type: K,
    listener: (this: CleaveViewer, event: CleaveViewerEventMap[K]) => unknown,
    options?: boolean | AddEventListenerOptions,
  ): void;
  addEventListener<K extends keyof HTMLElementEventMap>(
    type: K,
    listener: (this: CleaveViewer, event: HTMLElementEventMap[K]) => unknown,
    options?: boolean | AddEventListenerOptions,
  ): void;
  addEventListener(
    type: string,
    listener: EventListenerOrEventListenerObject,
    options?: boolean | AddEventListenerOptions,
  ): void;
  removeEventListener<K extends keyof CleaveViewerEventMap>(
    type: K,
    listener: (this: CleaveViewer, event: CleaveViewerEventMap[K]) => unknown,
    options?: boolean | EventListenerOptions,
  ): void;
  removeEventListener<K extends keyof HTMLElementEventMap>(
    type: K,
    listener: (this: CleaveViewer, event: HTMLElementEventMap[K]) => unknown,
    options?: boolean | EventListenerOptions,
  ): void;
  removeEventListener(
    type: string,
    listener: EventListenerOrEventListenerObject,
    options?: boolean | EventListenerOptions,
  ): void;
}

declare global {
  interface HTMLElementTagNameMap {
    "cleave-viewer": CleaveViewer;
  }
}
