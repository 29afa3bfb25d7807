/** Pairs of corners of faces that share an edge. */

const NONE = -1;

/**
 * Visit every edge that two faces share, as one corner of each face. Corner i stands for the edge to the next corner of
 * its face. If more than two faces share an edge, they are paired in the order of the corners.
 *
 * Corners that wait for their pair are in a list at one end of their edge: at the one with fewer faces, so that the lists
 * are short even if a vertex has very many.
 */
export function forAdjacentCorners(
  welded: Uint32Array,
  isWanted: Uint8Array | null,
  visit: (a: number, b: number) => void,
): void {
  const degree = degrees(welded);
  const first = new Int32Array(degree.length).fill(NONE); // of the list of each vertex
  const following = new Int32Array(welded.length);
  for (let i = 0; i < welded.length; i++) {
    if (isWanted !== null && !(isWanted[i] && isWanted[next(i)])) continue;
    const from = welded[i]!;
    const to = welded[next(i)]!;
    if (from === to) continue; // of a face without area
    const isAtFrom = degree[from]! < degree[to]! || (degree[from] === degree[to] && from < to);
    const place = isAtFrom ? from : to;
    const other = isAtFrom ? to : from;
    let before = NONE;
    let corner = first[place]!;
    while (corner !== NONE && welded[corner] !== other && welded[next(corner)] !== other) {
      before = corner;
      corner = following[corner]!;
    }
    if (corner === NONE) {
      following[i] = first[place]!;
      first[place] = i;
    } else {
      if (before === NONE) first[place] = following[corner]!;
      else following[before] = following[corner]!;
      visit(corner, i);
    }
  }
}

/** Return the number of corners at each vertex. */
function degrees(welded: Uint32Array): Uint32Array {
  let last = 0;
  for (let i = 0; i < welded.length; i++) if (welded[i]! > last) last = welded[i]!;
  const result = new Uint32Array(last + 1);
  for (let i = 0; i < welded.length; i++) result[welded[i]!]!++;
  return result;
}

/** Return the next corner of the face. */
export function next(corner: number): number {
  return corner % 3 === 2 ? corner - 2 : corner + 1;
}
