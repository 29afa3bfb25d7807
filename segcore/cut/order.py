"""The best order of the splits of a tree, given the gain and the cost of each."""

from heapq import heapify, heappop, heappush

import numpy as np

from segcore.arrays import FloatArray, IntArray, group_sums

_EQUAL = 1e-9  # difference of two losses over their costs that is a rounding error


def best_order(
    parent: IntArray, gain: FloatArray, cost: FloatArray, least_cost: float = 0.0, most_loss: float = 0.0
) -> tuple[list[int], int]:
    """Order the splits of a forest by decreasing ratio of gain and cost, parents before children.

    A split of low gain is moved forward if it makes splits of high gain possible: the splits are joined to blocks, and
    the blocks are ordered by total gain over total cost.

    Parameters
    ----------
    parent : (S,) the split that has to be made before, smaller than the split itself; -1 if there is none.
    gain : (S,) gain of every split, of any sign.
    cost : (S,) cost of every split, > 0.
    least_cost, most_loss : if the blocks of positive gain cost less than ``least_cost``, further blocks that lose at
        most ``most_loss`` times their cost are worthwhile as well, until that cost is reached, and beyond it those that
        lose as little as the last one of them: of equal parts all are cut off.

    Returns
    -------
    The splits in order, and how many of them are worthwhile: those in blocks of positive gain.

    References
    ----------
    Horn, Single-machine job sequencing with treelike precedence ordering and linear delay penalties, SIAM Journal on
    Applied Mathematics 23, 1972.
    """
    total_gain, total_cost = gain.tolist(), cost.tolist()
    members: list[list[int]] = [[s] for s in range(len(total_gain))]
    waiting: list[list[tuple[float, int]]] = [[] for _ in total_gain]  # heaps of the blocks that follow a block
    first: list[tuple[float, int]] = []
    for split in reversed(range(len(total_gain))):
        later = waiting[split]
        while later and -later[0][0] > total_gain[split] / total_cost[split]:
            _, block = heappop(later)
            total_gain[split] += total_gain[block]
            total_cost[split] += total_cost[block]
            members[split] += members[block]
            later += waiting[block]
            heapify(later)
        heappush(
            first if parent[split] < 0 else waiting[parent[split]], (-total_gain[split] / total_cost[split], split)
        )
    order: list[int] = []
    gainful = worthwhile = 0
    spent, reached = 0.0, -np.inf
    while first:
        loss, block = heappop(first)
        order += members[block]
        if loss < 0:
            gainful = worthwhile = len(order)
        elif loss <= most_loss and (spent < least_cost or loss <= reached):
            worthwhile = len(order)
            reached = loss + _EQUAL
        spent += total_cost[block]
        for entry in waiting[block]:
            heappush(first, entry)
    return order, worthwhile if cost[order[:worthwhile]].sum() >= least_cost else gainful


def best_order_of_steps(
    step: IntArray,
    parent: IntArray,
    gain: FloatArray,
    cost: FloatArray,
    least_cost: float = 0.0,
    most_loss: float = 0.0,
) -> tuple[list[int], int]:
    """``best_order`` of steps of one or more splits, which are made together; their gains and costs add up.

    Parameters
    ----------
    step : (S,) 0, 1, ...: the step of every split; those of a step follow each other. The parent of the first of them
        is the one that counts.
    """
    first = np.flatnonzero(np.diff(step, prepend=-1))
    parent_step = np.append(step, -1)[parent[first]]
    order, worthwhile = best_order(parent_step, group_sums(step, gain), group_sums(step, cost), least_cost, most_loss)
    members = np.split(np.arange(len(step)), first[1:])
    splits = [[int(s) for s in members[i]] for i in order]
    return [s for group in splits for s in group], sum(len(group) for group in splits[:worthwhile])
