/** The camera as the user has moved it; null until then, so that links show the whole model in any window. */

import type { CleaveViewer, View } from "../component/element";
import { byId } from "./dom";

export class Camera {
  #view: View | null = null;
  /** Whether the user has moved the camera. */
  #isMoved = false;

  constructor(viewer: CleaveViewer, onMove: () => void) {
    // The camera is damped and moves on after the input, so every move after the first input counts.
    const moved = () => (this.#isMoved = true);
    for (const name of ["pointerdown", "wheel", "keydown"]) viewer.addEventListener(name, moved, { passive: true });
    for (const id of ["reset-view", "isolate"]) byId(id).addEventListener("click", moved, { capture: true });
    viewer.addEventListener("cleave-view", () => {
      if (!this.#isMoved) return;
      this.#view = viewer.view;
      onMove();
    });
  }

  get view(): View | null {
    return this.#view;
  }

  /** Begin with the camera of a link; null for the first view. */
  begin(view: View | null): void {
    this.#view = view;
    this.#isMoved = false;
  }
}
