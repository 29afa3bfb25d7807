/** What the tools of the editor have in common. */

import type { CleaveViewer, Faces, Point } from "../../component/element";
import type { Session } from "../session";
import type { Editor } from "./editor";
import type { Overlay } from "./overlay";

export interface Desk {
  readonly viewer: CleaveViewer;
  readonly editor: Editor;
  readonly overlay: Overlay;
  session(): Session | null;
}

/** A tool marks faces with clicks, or draws strokes; strokes are told in points of the canvas. */
export interface Tool {
  readonly id: string;
  /** What to do, in a sentence. */
  readonly hint: string;
  /** Controls of the tool. */
  readonly options: readonly HTMLElement[];
  readonly draws: "clicks" | "strokes";
  /** CSS pixels around the pointer that the tool touches; 0 for a point. */
  readonly radius: number;
  /** Whether a stroke may begin beside the model. */
  readonly beginsAnywhere: boolean;
  /** Called after the tool was chosen, and after the parts have changed. */
  update(): void;
  click?(point: Point, isMinus: boolean): void;
  begin?(point: Point): void;
  move?(points: readonly Point[]): void;
  finish?(): void;
  /** Drop what is not stored; false if there was nothing. */
  drop(): boolean;
  /** Store what is shown; false if there is nothing. */
  apply?(): boolean;
}

/** Return the faces of the model; they exist while a tool is chosen. */
export function facesOf({ viewer }: Desk): Faces {
  const { sight } = viewer;
  if (sight === null) throw new Error("The model has no faces.");
  return sight;
}

/** Return the numbers of the selected parts. */
export function selectedParts({ session }: Desk): number[] {
  const now = session();
  return now === null ? [] : now.numbersOf(now.modes.selected);
}

/** Return the parts of some faces, those with the most first; locked ones are left out. */
export function partsUnder({ editor }: Desk, faces: readonly number[]): number[] {
  const counts = new Map<number, number>();
  for (const face of faces) {
    const part = editor.labels![face]!;
    if (!editor.parts[part]!.locked) counts.set(part, (counts.get(part) ?? 0) + 1);
  }
  return [...counts].sort((a, b) => b[1] - a[1]).map(([part]) => part);
}
