/** The state of a job on the page as one object, as links and the browser keep it. */

import type { View } from "../component/element";
import { editsOf, levelNear } from "./edits";
import type { Modes, Session } from "./session";

export interface JobState {
  /** The number of parts before cuts by hand; null for the automatic number. */
  readonly level: number | null;
  /** Nodes that are split, and nodes that are merged, by hand. */
  readonly split: readonly number[];
  readonly merged: readonly number[];
  readonly hidden: readonly number[];
  /** Names by node. */
  readonly names: Readonly<Record<number, string>>;
  /** The modes that differ from the first ones. */
  readonly modes: Partial<Modes>;
  readonly view: View | null;
  /** A second job that is shown beside the first. */
  readonly beside: string | null;
}

export const FIRST_STATE: JobState = {
  level: null,
  split: [],
  merged: [],
  hidden: [],
  names: {},
  modes: {},
  view: null,
  beside: null,
};

/** Return the state of a session. */
export function stateOf(session: Session, view: View | null, beside: string | null): JobState {
  const { work, modes, firstModes, automaticSegments } = session;
  const changed = Object.entries(modes).filter(([name, value]) => !isSame(value, firstModes[name as keyof Modes]));
  return {
    level: work.level === automaticSegments ? null : work.level,
    split: [...work.edits.split],
    merged: [...work.edits.merged],
    hidden: [...work.hidden],
    names: Object.fromEntries(work.names),
    modes: Object.fromEntries(changed),
    view,
    beside,
  };
}

/** Show a state in a session; numbers that its tree does not have are ignored. */
export function showState(session: Session, state: JobState): void {
  const { tree, automaticSegments, firstModes } = session;
  const known = (ids: readonly number[]) => new Set(ids.filter((id) => id >= 0 && id < tree.nodes.length));
  const isInner = (id: number) => tree.node(id).children.length > 0;
  const names = Object.entries(state.names).map(([id, name]) => [Number(id), name] as const);
  session.restore(
    {
      level: Math.min(Math.max(state.level ?? automaticSegments, 1), tree.maxSegments),
      edits: { split: new Set([...known(state.split)].filter(isInner)), merged: known(state.merged) },
      hidden: known(state.hidden),
      names: new Map(names.filter(([id]) => id < tree.nodes.length)),
    },
    { ...firstModes, ...state.modes },
  );
}

/** Return the state with the parts of some splits, as links of earlier versions name them. */
export function withSplits(state: JobState, { tree }: Session, splits: readonly number[]): JobState {
  const cut = tree.cutOfSplits(splits);
  const level = levelNear(cut);
  const { split, merged } = editsOf(tree, level, cut);
  return { ...state, level, split: [...split], merged: [...merged] };
}

function isSame(a: unknown, b: unknown): boolean {
  return JSON.stringify(a) === JSON.stringify(b);
}
