/** Operations for parts that have got other numbers. */

import type { Operation } from "./revisions";

/** Return operations with the numbers of parts replaced; ``after`` has the new number of each. */
export function renumbered(operations: readonly Operation[], after: readonly number[]): Operation[] {
  const of = (part: number) => after[part] ?? part;
  return operations.map((operation): Operation => {
    switch (operation.op) {
      case "merge":
        return { ...operation, parts: operation.parts.map(of) };
      case "smooth":
        return { ...operation, parts: operation.parts?.map(of) ?? null };
      case "assign":
      case "part":
        return { ...operation, to: operation.to === "new" ? "new" : of(operation.to) };
      case "border":
        return { ...operation, a: of(operation.a), b: of(operation.b) };
      case "restore":
        return operation;
      default:
        return { ...operation, part: of(operation.part) };
    }
  });
}
