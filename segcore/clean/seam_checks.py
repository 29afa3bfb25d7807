"""Which matches of open edges are seams of one surface, and not borders that happen to pass each other."""

import numpy as np
from numba import njit

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray, group_sums
from segcore.clean.seams import LARGEST_GAP, Matches
from segcore.clean.topology import DualEdges, consistent_orientation
from segcore.clean.welding import WELD_TOLERANCE
from segcore.graphs.surface_graph import connected_components, rows_of

_LARGEST_GROWTH = 0.1  # share by which a seam may become longer if its tolerance is doubled; set by hand
# Least lengths in mean gaps, set by hand: of a seam of two patches, and of all seams that are connected.
_SHORTEST_RUN = 2.0
_SHORTEST_NETWORK = 10.0


def seams_of(matches: Matches, faces: IntArray, dual: DualEdges, borders: IntArray) -> Matches:
    """The matches that belong to seams.

    The tolerance of a seam is found from the seam itself. A run is a set of matches between two patches (sets of faces
    that edges connect) that follow each other. Its tolerance is the largest gap in it so that a tolerance twice as large
    makes the run at most a tenth longer: two borders that were one are near over their whole length, and borders that
    merely pass each other diverge. What is farther apart is left out, and so are runs and networks of runs that are
    short for their gaps, and what would give a patch two orientations.

    Parameters
    ----------
    borders : (B, 2) face and first corner of every open edge.
    """
    if len(matches.gap) == 0:
        return matches
    patch, is_flipped = consistent_orientation(rows_of(dual.faces, len(faces)), dual)
    count = int(patch.max()) + 1
    matches = matches.select(_within_runs(matches, patch, faces, borders))
    matches = matches.select(_within_networks(matches, faces, borders))
    sides = borders[matches.edges, 0]
    turned = matches.disagrees ^ is_flipped[sides[:, 0]] ^ is_flipped[sides[:, 1]]
    return matches.select(_orientable(_pairs(matches, patch, borders), turned, matches.length, count))


def _pairs(matches: Matches, patch: IntArray, borders: IntArray) -> LongArray:
    """(M,) the patches i <= j at every match, as the number i * number of patches + j."""
    between = np.sort(patch[borders[matches.edges, 0]], axis=1).astype(np.int64)
    pairs: LongArray = between[:, 0] * (int(patch.max()) + 1) + between[:, 1]
    return pairs


def _within_runs(matches: Matches, patch: IntArray, faces: IntArray, borders: IntArray) -> BoolArray:
    """(M,) True for the matches within the tolerance of their run, if the run is long enough for its gaps."""
    run = _connected(matches, _pairs(matches, patch, borders), faces, borders)
    order = np.lexsort((matches.gap, run))
    is_within = np.zeros(len(run), dtype=bool)
    is_within[order] = _within_tolerance(run[order], matches.gap[order], matches.length[order])
    return is_within & _is_long(run, matches, is_within, _SHORTEST_RUN)


def _within_networks(matches: Matches, faces: IntArray, borders: IntArray) -> BoolArray:
    """(M,) True for the matches of connected runs that are together long enough for their gaps."""
    every = np.ones(len(matches.gap), dtype=bool)
    network = _connected(matches, np.zeros(len(every), dtype=np.int64), faces, borders)
    return _is_long(network, matches, every, _SHORTEST_NETWORK)


def _is_long(group: IntArray, matches: Matches, counts: BoolArray, least: float) -> BoolArray:
    """(M,) True if the matches of the group that count are together at least so many times as long as their mean gap."""
    length = group_sums(group, matches.length * counts)
    moment = group_sums(group, matches.length * matches.gap * counts)
    long_enough: BoolArray = (length**2 >= least * moment)[group]
    return long_enough


def _connected(matches: Matches, kind: LongArray, faces: IntArray, borders: IntArray) -> IntArray:
    """(M,) the set of every match: those of one kind (M,) whose edges have an end in common are connected."""
    face, corner = borders.T
    ends = np.stack([faces[face, corner], faces[face, (corner + 1) % 3]], axis=1)[matches.edges].reshape(-1, 4)
    _, kind = np.unique(kind, return_inverse=True)
    key = np.repeat(kind, 4) * (int(faces.max()) + 1) + ends.ravel()
    different, place = np.unique(key, return_inverse=True)
    match = np.repeat(np.arange(len(kind)), 4)
    links = np.stack([match, len(kind) + place], axis=1).astype(np.int32)
    return connected_components(links, len(kind) + len(different))[: len(kind)]


@njit(cache=True)
def _within_tolerance(run: IntArray, gap: FloatArray, length: FloatArray) -> BoolArray:
    """(M,) True for the matches within the tolerance of their run; sorted by run, then by gap."""
    is_within = np.zeros(len(run), np.bool_)
    begin = 0
    while begin < len(run):
        end = begin
        while end < len(run) and run[end] == run[begin]:
            end += 1
        inside, doubled, further, last = 0.0, 0.0, begin, begin - 1
        for i in range(begin, end):
            if gap[i] > LARGEST_GAP:
                break
            inside += length[i]
            while further < end and gap[further] <= 2.0 * max(gap[i], WELD_TOLERANCE):
                doubled += length[further]
                further += 1
            if doubled <= (1.0 + _LARGEST_GROWTH) * inside:
                last = i
        is_within[begin : last + 1] = True
        begin = end
    return is_within


def _orientable(pair: LongArray, turned: BoolArray, length: FloatArray, count: int) -> BoolArray:
    """(M,) True for the matches that leave every patch with one orientation relative to every other.

    Patches are joined in the order of the length of their seams, and what contradicts the seams before is left out.

    Parameters
    ----------
    pair : (M,) the patches i <= j of both edges as i * count + j.
    turned : (M,) one of the two patches has to be turned against the other.
    length : (M,)
    count : number of patches.
    """
    different, seam = np.unique(2 * pair + turned, return_inverse=True)
    order = np.argsort(-group_sums(seam, length), kind="stable")
    patches = np.stack([different // 2 // count, different // 2 % count, different % 2], axis=1)
    fits = np.zeros(len(different), dtype=bool)
    fits[order] = _without_contradiction(patches[order], count)
    return fits[seam]


@njit(cache=True)
def _without_contradiction(seams: LongArray, count: int) -> BoolArray:
    """(S,) True for seams, in their order, that fit the ones before: a union of sets with a parity to the root.

    Parameters
    ----------
    seams : (S, 3) two patches 0..count - 1, and 1 if one of them has to be turned against the other.
    """
    root = np.arange(count)
    parity = np.zeros(count, np.int64)
    fits = np.zeros(len(seams), np.bool_)
    for s in range(len(seams)):
        a, b, turned = seams[s]
        a, from_a = _root(root, parity, a)
        b, from_b = _root(root, parity, b)
        turned ^= from_a ^ from_b
        if a != b:
            root[max(a, b)], parity[max(a, b)] = min(a, b), turned
        fits[s] = a != b or turned == 0
    return fits


@njit(cache=True)
def _root(root, parity, a):  # type: ignore[no-untyped-def]
    """The root of the set of an element, and its parity to it; the path to it is halved."""
    turned = 0
    while root[a] != a:
        above = root[a]
        parity[a] ^= parity[above]  # that of a root is 0
        root[a] = root[above]
        turned ^= parity[a]
        a = root[a]
    return a, turned
