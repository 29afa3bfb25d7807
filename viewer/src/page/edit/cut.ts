/** Divides a part along a drawn line. */

import { announce } from "../dom";
import { runsOf } from "./face_runs";
import { LineTool } from "./line_tool";
import { partsUnder, selectedParts } from "./tool";

export class CutTool extends LineTool {
  readonly id = "cut";
  readonly hint = "Draw a line across a part to divide it. The right button or two fingers turn the model.";
  readonly options = [];

  protected drawn(faces: readonly number[]): void {
    const { editor } = this.desk;
    const under = partsUnder(this.desk, faces);
    const part = selectedParts(this.desk).find((selected) => under.includes(selected)) ?? under[0];
    if (part === undefined) return announce("The part is locked.");
    const stroke = runsOf(faces.filter((face) => editor.labels![face] === part));
    void editor.edit([{ op: "cut", part, stroke }], "The part is divided");
  }
}
