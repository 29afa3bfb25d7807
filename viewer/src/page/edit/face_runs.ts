/** Sets of faces and their labels as runs of consecutive numbers, as the API sends and takes them. */

export interface FaceRuns {
  readonly starts: number[];
  readonly lengths: number[];
}

/** Faces with new labels, each run with one. */
export interface ChangedFaces extends FaceRuns {
  readonly labels: number[];
}

/** Return faces as runs. */
export function runsOf(faces: Iterable<number>): FaceRuns {
  const sorted = Uint32Array.from(faces).sort();
  const runs: FaceRuns = { starts: [], lengths: [] };
  for (const face of sorted) {
    const last = runs.starts.length - 1;
    const end = last < 0 ? -1 : runs.starts[last]! + runs.lengths[last]!;
    if (last >= 0 && face < end) continue; // given twice
    if (face === end) runs.lengths[last]!++;
    else {
      runs.starts.push(face);
      runs.lengths.push(1);
    }
  }
  return runs;
}

/** Return labels with some of them changed. */
export function changedLabels(labels: Int32Array, { starts, lengths, labels: after }: ChangedFaces): Int32Array {
  const changed = labels.slice();
  starts.forEach((start, i) => changed.fill(after[i]!, start, start + lengths[i]!));
  return changed;
}

/** Return for each old label the new one that most of its faces have; of some labels only, if they are given. */
export function successors(before: Int32Array, after: Int32Array, wanted: ReadonlySet<number> | null = null): number[] {
  const votes: Map<number, number>[] = [];
  for (let face = 0; face < before.length; face++) {
    if (wanted !== null && !wanted.has(before[face]!)) continue;
    const own = (votes[before[face]!] ??= new Map<number, number>());
    own.set(after[face]!, (own.get(after[face]!) ?? 0) + 1);
  }
  return Array.from(votes, (own) => [...(own ?? [])].reduce((best, vote) => (vote[1] > best[1] ? vote : best), [0, 0])[0]);
}
