"""Which matches of open edges join parts of one surface, and which are borders that happen to pass each other."""

import numpy as np

from segcore.arrays import BoolArray, FloatArray, IntArray, LongArray, group_sums
from segcore.clean.borders import ends_of
from segcore.clean.matches import LARGEST_GAP, Matches
from segcore.clean.topology import DualEdges, consistent_orientation
from segcore.clean.welding import WELD_TOLERANCE
from segcore.graphs.surface_graph import connected_components, rows_of
from segcore.jit.decorators import inner_kernel, kernel

_LARGEST_GROWTH = 0.1  # share by which a run may become longer if its tolerance is doubled; set by hand
# Set by hand: the least length of a run in mean gaps, also if one of its patches has to be turned, unless the runs of
# one of its patches are at least a share of the open edges of the patch.
_SHORTEST_RUN = 40.0
_SHORTEST_TURNED_RUN = 400.0
_ENCLOSED = 0.5


def reliable_matches(
    matches: Matches, faces: IntArray, dual: DualEdges, borders: IntArray, length: FloatArray
) -> Matches:
    """The matches that join parts of one surface.

    The tolerance is found from every run of matches. A run is a set of matches between two patches (sets of faces
    that edges connect) that follow each other. Its tolerance is the largest gap in it so that a tolerance twice as
    large makes the run at most a tenth longer: two borders that were one are near over their whole length, and borders
    that merely pass each other diverge. What is farther apart is left out. So are runs that are short for their gaps,
    with a higher limit if they contradict the orientations of the input, unless half of what is open at one of the
    patches is matched; and what would give a patch two orientations.

    Parameters
    ----------
    borders : (B, 2) face and first corner of every open edge.
    length : (B,) of the open edges.
    """
    if len(matches.gap) == 0:
        return matches
    patch, is_flipped = consistent_orientation(rows_of(dual.faces, len(faces)), dual)
    sides = borders[matches.edges, 0]
    turned = matches.disagrees ^ is_flipped[sides[:, 0]] ^ is_flipped[sides[:, 1]]
    between = np.sort(patch[sides], axis=1)
    run = _runs(matches, between, faces, borders)
    is_within = _within_tolerances(matches, run)
    least = np.where(turned, _SHORTEST_TURNED_RUN, _SHORTEST_RUN)
    is_long = _are_long(matches, run, is_within, least)
    share = _closed_share(matches.length * is_within, patch[borders[:, 0]], length, between)
    chosen = np.flatnonzero(is_within & (is_long | (share >= _ENCLOSED)))
    return matches.select(chosen[_orientable(between[chosen], turned[chosen], matches.length[chosen])])


def _within_tolerances(matches: Matches, run: IntArray) -> BoolArray:
    """(M,) True for the matches within the tolerance of their run."""
    order = np.lexsort((matches.gap, run))
    is_within = np.zeros(len(run), dtype=bool)
    is_within[order] = _within_tolerance(run[order], matches.gap[order], matches.length[order])
    return is_within


def _are_long(matches: Matches, run: IntArray, is_within: BoolArray, least: FloatArray) -> BoolArray:
    """(M,) True if the matches of a run that are within its tolerance have a least length (M,) in their mean gaps."""
    length = group_sums(run, matches.length * is_within)
    moment = group_sums(run, matches.length * matches.gap * is_within)
    are_long: BoolArray = (length**2)[run] >= least * moment[run]
    return are_long


def _closed_share(matched: FloatArray, patch: IntArray, length: FloatArray, between: IntArray) -> FloatArray:
    """(M,) the share of the open edges of a patch that matches cover, of the two patches of a match the larger.

    Parameters
    ----------
    matched : (M,) the length that every match covers.
    patch, length : (B,) of the open edges.
    between : (M, 2) the two patches.
    """
    count = int(patch.max()) + 1
    closed = group_sums(between.ravel(), np.repeat(matched, 2), count)
    share: FloatArray = (closed / np.maximum(group_sums(patch, length, count), np.finfo(float).tiny))[between]
    return share.max(axis=1)


def _runs(matches: Matches, between: IntArray, faces: IntArray, borders: IntArray) -> IntArray:
    """(M,) the run of every match: those between the same patches (M, 2) whose edges have an end in common."""
    _, pair = np.unique(between[:, 0].astype(np.int64) * (int(between.max()) + 1) + between[:, 1], return_inverse=True)
    ends = ends_of(borders, faces)[matches.edges].reshape(-1, 4)
    key = np.repeat(pair, 4) * (int(faces.max()) + 1) + ends.ravel()
    different, place = np.unique(key, return_inverse=True)
    match = np.repeat(np.arange(len(pair)), 4)
    links = np.stack([match, len(pair) + place], axis=1).astype(np.int32)
    return connected_components(links, len(pair) + len(different))[: len(pair)]


@kernel
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


def _orientable(between: IntArray, turned: BoolArray, length: FloatArray) -> BoolArray:
    """(M,) True for the matches that leave every patch with one orientation relative to every other.

    Patches are joined in the order of the length of their matches, and what contradicts those before is left out.

    Parameters
    ----------
    between : (M, 2) the patches at both edges, the smaller first.
    turned : (M,) one of the two patches has to be turned against the other.
    length : (M,)
    """
    count = int(between.max(initial=0)) + 1
    key = 2 * (between[:, 0].astype(np.int64) * count + between[:, 1]) + turned
    different, pair = np.unique(key, return_inverse=True)
    order = np.argsort(-group_sums(pair, length), kind="stable")
    patches = np.stack([different // 2 // count, different // 2 % count, different % 2], axis=1)
    fits = np.zeros(len(different), dtype=bool)
    fits[order] = _without_contradiction(patches[order], count)
    return fits[pair]


@kernel
def _without_contradiction(pairs: LongArray, count: int) -> BoolArray:
    """(S,) True for pairs, in their order, that fit the ones before: a union of sets with a parity to the root.

    Parameters
    ----------
    pairs : (S, 3) two patches 0..count - 1, and 1 if one of them has to be turned against the other.
    """
    root = np.arange(count)
    parity = np.zeros(count, np.int64)
    fits = np.zeros(len(pairs), np.bool_)
    for s in range(len(pairs)):
        a, b, turned = pairs[s]
        a, from_a = _root(root, parity, a)
        b, from_b = _root(root, parity, b)
        turned ^= from_a ^ from_b
        if a != b:
            root[max(a, b)], parity[max(a, b)] = min(a, b), turned
        fits[s] = a != b or turned == 0
    return fits


@inner_kernel
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
