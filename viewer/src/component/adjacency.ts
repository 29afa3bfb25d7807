/** Pairs of corners of faces that share an edge. */

const FREE = -1; // states of a slot in the hash table of corners
const PAIRED = -2;

/**
 * Visit every edge that two faces share, as one corner of each face. Corner i stands for the edge to the next corner of
 * its face. If more than two faces share an edge, they are paired in the order of the corners.
 */
export function forAdjacentCorners(
  welded: Uint32Array,
  isWanted: Uint8Array | null,
  visit: (a: number, b: number) => void,
): void {
  let count = 0;
  for (let i = 0; i < welded.length; i++) if (isWanted === null || (isWanted[i] && isWanted[next(i)])) count++;
  const size = 2 ** Math.ceil(Math.log2(2 * count + 1));
  const table = new Int32Array(size).fill(FREE);
  for (let i = 0; i < welded.length; i++) {
    if (isWanted !== null && !(isWanted[i] && isWanted[next(i)])) continue;
    const from = welded[i]!;
    const to = welded[next(i)]!;
    let slot = (Math.imul(Math.min(from, to), 0x9e3779b1) ^ Math.imul(Math.max(from, to), 0x85ebca6b)) & (size - 1);
    for (; table[slot] !== FREE; slot = (slot + 1) & (size - 1)) {
      const other = table[slot]!;
      if (other === PAIRED) continue;
      const a = welded[other]!;
      const b = welded[next(other)]!;
      if ((a !== to || b !== from) && (a !== from || b !== to)) continue;
      visit(other, i);
      table[slot] = PAIRED;
      break;
    }
    if (table[slot] === FREE) table[slot] = i;
  }
}

/** Return the next corner of the face. */
export function next(corner: number): number {
  return corner % 3 === 2 ? corner - 2 : corner + 1;
}
