"""The LRU cache of results."""

from service.result_cache import LruCache


def test_the_least_recently_used_value_is_dropped_first() -> None:
    cache: LruCache[str, bytes] = LruCache(max_bytes=3, size_bytes=len)
    for key in ("a", "b", "a", "c", "d"):
        cache.get(key, lambda: b"x")
    made = {key for key in ("d", "c", "a") if cache.get(key, lambda: b"new") == b"new"}
    assert made == set()
    assert cache.get("b", lambda: b"y") == b"y"


def test_a_value_larger_than_the_cache_is_returned_but_not_kept() -> None:
    cache: LruCache[str, bytes] = LruCache(max_bytes=3, size_bytes=len)
    assert cache.get("a", lambda: b"long") == b"long"
    assert cache.get("a", lambda: b"new") == b"new"


def test_dropped_values_are_made_again() -> None:
    cache: LruCache[str, bytes] = LruCache(max_bytes=3, size_bytes=len)
    for key in ("a", "b"):
        cache.get(key, lambda: b"x")
    cache.drop(lambda key: key == "a")
    assert cache.get("a", lambda: b"y") == b"y"
    assert cache.get("b", lambda: b"y") == b"x"
