/** What tools have in common that draw a line on the model. */

import type { Point } from "../../component/element";
import { announce } from "../dom";
import { PathTool } from "./path_tool";
import { facesOf } from "./tool";

const HALF_WIDTH = 2.5; // CSS pixels around the line whose faces belong to it

export abstract class LineTool extends PathTool {
  protected finished(path: readonly Point[]): void {
    const faces = facesOf(this.desk).alongPath(path, HALF_WIDTH);
    if (faces.length < 2) announce("Draw the line on the model.");
    else this.drawn(faces, path);
  }

  /** Handle the faces under a finished line. */
  protected abstract drawn(faces: readonly number[], path: readonly Point[]): void;
}
