"""Locks in Redis: one holder at a time, until it releases the lock or the lock expires."""

from redis import Redis

from helpers.waiting import wait_until
from worker.jobs.queue.locks import Locks


def test_one_process_leads_until_its_leadership_expires(connection: Redis) -> None:
    locks = Locks(connection)
    assert locks.lead("janitor-1", ttl_s=0.3)
    assert not locks.lead("janitor-2", ttl_s=10)
    assert locks.lead("janitor-1", ttl_s=0.3)
    wait_until(lambda: locks.lead("janitor-2", ttl_s=10), within_s=10)
    assert not locks.lead("janitor-1", ttl_s=10)


def test_a_lock_has_one_holder_until_it_is_released_or_expires(connection: Redis) -> None:
    locks = Locks(connection)
    assert locks.acquire("webhook:1", "sender-1", ttl_s=10)
    assert not locks.acquire("webhook:1", "sender-2", ttl_s=10)
    assert locks.acquire("webhook:2", "sender-2", ttl_s=0.3)
    locks.release("webhook:1")
    assert locks.acquire("webhook:1", "sender-2", ttl_s=10)
    wait_until(lambda: locks.acquire("webhook:2", "sender-1", ttl_s=10), within_s=10)
