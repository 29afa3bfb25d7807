"""The order and the kinds of the faults of a soak."""

import random
from collections import Counter

from bench.soak.faults import EMPTIED_QUEUE_SERVER, QUEUE_SERVER, schedule


def test_the_same_seed_gives_the_same_faults_with_all_kinds() -> None:
    faults = schedule(100, 6, random.Random(3))
    assert faults == schedule(100, 6, random.Random(3))
    assert faults != schedule(100, 6, random.Random(4))
    counts = Counter(faults)
    assert (counts[QUEUE_SERVER], counts[EMPTIED_QUEUE_SERVER]) == (5, 1)
    assert counts.total() == 106
    assert set(counts) >= {"work-horse", "worker", "worker and work-horse", "janitor", "service"}


def test_the_number_of_faults_is_the_requested_one() -> None:
    assert len(schedule(2, 0, random.Random(1))) == 2
    assert schedule(0, 1, random.Random(1)) == [EMPTIED_QUEUE_SERVER]
