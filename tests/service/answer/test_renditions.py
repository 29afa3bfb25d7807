"""Results as a client fetches them: any level, once, in parts, as a picture."""

import io
import json
import struct
import zipfile
from collections.abc import Callable

import httpx
import matplotlib.image
import pytest

from helpers.api import FACES, problem

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
def test_a_result_is_sent_once_and_in_any_part(
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
def test_what_shrinks_is_compressed_for_those_who_take_it(
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


def test_a_range_is_never_of_compressed_bytes(client: httpx.Client, finished_job: Callable[..., str]) -> None:
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
def test_what_hardly_shrinks_is_sent_as_it_is(
    client: httpx.Client, finished_job: Callable[..., str], result: str
) -> None:
    answer = client.get(f"{finished_job()}/{result}", headers={"Accept-Encoding": "gzip"})
    assert {"Content-Encoding", "Vary"}.isdisjoint(answer.headers)


def test_different_results_have_different_tags(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    paths = [finished_job(), finished_job()]
    tags = [client.get(f"{path}/{result}").headers["ETag"] for path in paths for result in PATHS]
    assert len(set(tags)) == len(tags)


def test_the_curve_has_a_point_for_every_cut(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    document = client.get(f"{finished_job()}/hierarchy").json()
    assert [point["segments"] for point in document["curve"]] == list(range(2, document["max_segments"] + 1))
    assert [point["cut_value"] for point in document["curve"]] == document["cut_values"]
    for point in document["curve"]:
        assert document["nodes"][point["node"]]["cut_value"] == point["cut_value"]


def test_one_model_can_hold_every_level(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    data = client.get(f"{path}/model.glb", params={"levels": "all", "features": True}).content
    (length,) = struct.unpack_from("<I", data, 12)
    model = json.loads(data[20 : 20 + length])
    most = client.get(path).json()["max_segments"]
    assert len(model["nodes"]) == 2 * most - 1
    assert len(model["extensions"]["KHR_materials_variants"]["variants"]) == most
    (table,) = model["extensions"]["EXT_structural_metadata"]["propertyTables"]
    assert table["count"] == 2 * most - 1
    plain = client.get(f"{path}/model.glb", params={"levels": "all"}).content
    assert b"EXT_structural_metadata" not in plain
    problem(client.get(f"{path}/model.glb?levels=some"), 422, "invalid_request")


def test_the_preview_shows_the_segments(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    answer = client.get(f"{path}/preview.png", params={"size": 64})
    assert answer.headers["Content-Type"] == "image/png"
    picture = matplotlib.image.imread(io.BytesIO(answer.content))
    assert picture.shape == (64, 64, 4)
    assert picture[32, 32, 3] == 1
    assert picture[0, 0, 3] == 0
    assert client.get(f"{path}/preview.png", params={"segments": 5, "size": 64}).content != answer.content
    problem(client.get(f"{path}/preview.png", params={"size": 100_000}), 422, "invalid_request")
    problem(client.get(f"{path}/preview.png", params={"segments": FACES}), 422, "invalid_parameters")


@pytest.mark.parametrize(
    ("result", "media_type", "begins"),
    [
        ("model.glb", "model/gltf-binary", b"glTF"),
        ("model.ply", "model/ply", b"ply"),
        ("model.obj", "model/obj", b""),
        ("model.3mf", "model/3mf", b"PK"),
        ("parts.zip", "application/zip", b"PK"),
    ],
)
def test_models_are_files_to_be_saved(
    client: httpx.Client, finished_job: Callable[..., str], result: str, media_type: str, begins: bytes
) -> None:
    answer = client.get(f"{finished_job()}/{result}", params={"segments": 3})
    assert answer.headers["Content-Type"] == media_type
    assert answer.headers["Content-Disposition"].startswith("attachment; filename=")
    assert answer.content.startswith(begins)


def test_parts_are_a_file_per_segment(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    for form in ("stl", "obj"):
        data = client.get(f"{path}/parts.zip", params={"segments": 3, "part_format": form}).content
        names = zipfile.ZipFile(io.BytesIO(data)).namelist()
        assert names == [f"segment_{number}.{form}" for number in range(3)]
