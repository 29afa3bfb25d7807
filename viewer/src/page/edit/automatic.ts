/** A level of the automatic result and its parts, as the API describes them. */

import type { CleaveViewer } from "../../component/element";
import type { Session } from "../session";
import type { Level, Part } from "./revisions";

/** Return the level that a session shows. */
export function levelOf({ tree, work }: Session): Level {
  const level = tree.levelOf(work.cut);
  return level === null ? { splits: tree.splitsOf(work.cut) } : { segments: level };
}

/** Return what a first revision would say of a part. */
export function partOfLevel(viewer: CleaveViewer, { tree, work }: Session, id: number): Part {
  const channels = viewer.shadeOf(id).map((channel) => Math.round(255 * channel).toString(16).padStart(2, "0"));
  return { name: work.names.get(id) ?? "", color: `#${channels.join("")}`, class: "", locked: false, faces: tree.node(id).faces };
}
