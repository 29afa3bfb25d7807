/** Compiles only if the types of <cleave-viewer> say what docs/reference/viewer.md says. */
import type { ErrorDetail, View, ViewerState } from "./cleave-viewer";

type Equal<A, B> = (<T>() => T extends A ? 1 : 2) extends <T>() => T extends B ? 1 : 2 ? true : false;
function same<A, B>(..._: Equal<A, B> extends true ? [] : [never]): void {}

const viewer = document.querySelector("cleave-viewer")!;
const same_element = document.createElement("cleave-viewer");
same<typeof viewer, typeof same_element>();
same<typeof viewer.state, ViewerState>();
same<typeof viewer.error, ErrorDetail | null>();
same<typeof viewer.view, View>();
viewer.addEventListener("cleave-select", ({ detail }) => same<typeof detail.parts, readonly number[]>());
viewer.addEventListener("cleave-load", function ({ detail }) {
  same<typeof detail.limitReached, boolean | null>();
  if (this.tree !== null) this.cut = this.tree.split(this.tree.cutAt(7), 3);
});
viewer.addEventListener("keydown", (event) => same<typeof event, KeyboardEvent>());
viewer.addEventListener("cleave-error", ({ detail }) => {
  // @ts-expect-error: the code is none of the enumeration
  detail.code === "no_such_code";
});
viewer.names = new Map([[3, "arm"]]);
// @ts-expect-error: the tree cannot be set
viewer.tree = null;
