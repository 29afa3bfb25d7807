"""Responses with ETags, byte ranges and compression."""

from collections.abc import Callable

import httpx
import pytest

from helpers.api import problem

PATHS = [
    "labels",
    "hierarchy",
    "model.glb",
    "model.glb?levels=all",
    "preview.png",
    "labels?segments=2",
    "model.ply",
    "model.obj",
    "model.3mf",
    "parts.zip?capped=true",
]


@pytest.mark.parametrize("result", PATHS)
def test_a_result_supports_conditional_requests_and_ranges(
    client: httpx.Client, finished_job: Callable[..., str], result: str
) -> None:
    url = f"{finished_job()}/{result}"
    client.headers["Accept-Encoding"] = "identity"
    whole = client.get(url)
    assert whole.headers["Accept-Ranges"] == "bytes"
    assert "immutable" in whole.headers["Cache-Control"]
    tag = whole.headers["ETag"]
    for known in (tag, f'W/{tag}, "other"', "*"):
        assert client.get(url, headers={"If-None-Match": known}).status_code == 304
    assert client.get(url, headers={"If-None-Match": '"other"'}).content == whole.content
    size = len(whole.content)
    for asked, first, last in (
        ("0-0", 0, 0),
        ("5-20", 5, 20),
        (f"{size - 3}-", size - 3, size - 1),
        ("-4", size - 4, size - 1),
    ):
        part = client.get(url, headers={"Range": f"bytes={asked}", "If-Range": tag})
        assert part.status_code == 206
        assert part.headers["Content-Range"] == f"bytes {first}-{last}/{size}"
        assert part.content == whole.content[first : last + 1]
    problem(client.get(url, headers={"Range": f"bytes={size}-"}), 416, "range_not_satisfiable")
    for ignored in ({"Range": "bytes=0-1", "If-Range": '"other"'}, {"Range": "bytes=0-1,3-4"}, {"Range": "lines=1-2"}):
        assert client.get(url, headers=ignored).status_code == 200


@pytest.mark.parametrize(
    "result", ["labels", "labels?format=seg", "labels?format=raw", "labels?format=npy", "hierarchy"]
)
def test_labels_and_the_hierarchy_are_compressed_if_accepted(
    client: httpx.Client, finished_job: Callable[..., str], result: str
) -> None:
    url = f"{finished_job()}/{result}"
    plain = client.get(url, headers={"Accept-Encoding": "br, gzip;q=0"})
    packed = client.get(url, headers={"Accept-Encoding": "br, gzip;q=0.5"})
    assert "Content-Encoding" not in plain.headers
    assert packed.headers["Content-Encoding"] == "gzip"
    assert packed.content == plain.content  # httpx unpacks it
    assert int(packed.headers["Content-Length"]) < int(plain.headers["Content-Length"]) / 2
    assert packed.headers["ETag"] != plain.headers["ETag"]
    for answer in (plain, packed):
        assert "Accept-Encoding" in answer.headers["Vary"]
    known = {"Accept-Encoding": "gzip", "If-None-Match": packed.headers["ETag"]}
    assert client.get(url, headers=known).status_code == 304


def test_ranges_refer_to_uncompressed_bytes(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    url = f"{finished_job()}/labels"
    packed = client.get(url, headers={"Accept-Encoding": "gzip"})
    asked = {"Accept-Encoding": "gzip", "Range": "bytes=1-9"}
    part = client.get(url, headers=asked)
    assert (part.status_code, part.content) == (206, packed.content[1:10])
    assert "Content-Encoding" not in part.headers
    assert part.headers["ETag"] != packed.headers["ETag"]
    whole = client.get(url, headers={**asked, "If-Range": packed.headers["ETag"]})
    assert (whole.status_code, whole.content) == (200, packed.content)


@pytest.mark.parametrize("result", ["model.glb", "model.3mf", "preview.png"])
def test_models_and_pictures_are_not_compressed(
    client: httpx.Client, finished_job: Callable[..., str], result: str
) -> None:
    answer = client.get(f"{finished_job()}/{result}", headers={"Accept-Encoding": "gzip"})
    assert {"Content-Encoding", "Vary"}.isdisjoint(answer.headers)


def test_different_results_have_different_tags(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    paths = [finished_job(), finished_job()]
    tags = [client.get(f"{path}/{result}").headers["ETag"] for path in paths for result in PATHS]
    assert len(set(tags)) == len(tags)
