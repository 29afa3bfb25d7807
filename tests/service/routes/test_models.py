"""The segmented mesh as files and as a picture."""

import io
import json
import re
import struct
import zipfile
from collections.abc import Callable

import httpx
import matplotlib.image
import pytest
import trimesh

from cleave.settings import Settings
from helpers.api import FACES, problem
from service.answer.model_formats import MODELS
from service.routes.models import OPTIONS
from worker.jobs.store.store import JobStore
from worker.process.perform import perform


def test_the_model_is_a_glb_of_the_segments(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    answer = client.get(f"{finished_job()}/model.glb", params={"segments": 3})
    assert answer.headers["Content-Type"] == "model/gltf-binary"
    assert answer.content[:4] == b"glTF"
    assert b"segment 2" in answer.content
    assert b"segment 3" not in answer.content


def test_a_glb_can_contain_every_level(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    data = client.get(f"{path}/model.glb", params={"levels": "all", "features": True}).content
    (length,) = struct.unpack_from("<I", data, 12)
    model = json.loads(data[20 : 20 + length])
    most = client.get(path).json()["max_segments"]
    assert len(model["meshes"]) == most
    assert len(model["scenes"][0]["extras"]["split_node"]) == most - 1
    assert len(model["extensions"]["KHR_materials_variants"]["variants"]) == most
    (table,) = model["extensions"]["EXT_structural_metadata"]["propertyTables"]
    assert table["count"] == 2 * most - 1
    plain = client.get(f"{path}/model.glb", params={"levels": "all"}).content
    assert b"EXT_structural_metadata" not in plain
    problem(client.get(f"{path}/model.glb?levels=some"), 422, "invalid_request")


@pytest.mark.parametrize(
    ("result", "media_type", "begins"),
    [
        ("model.glb", "model/gltf-binary", b"glTF"),
        ("model.ply", "model/ply", b"ply"),
        ("model.obj", "model/obj", b"# written by Cleave"),
        ("model.mtl", "model/mtl", b"# written by Cleave"),
        ("model.obj.zip", "application/zip", b"PK"),
        ("model.3mf", "model/3mf", b"PK"),
        ("parts.zip", "application/zip", b"PK"),
    ],
)
def test_models_are_sent_as_attachments(
    client: httpx.Client, finished_job: Callable[..., str], result: str, media_type: str, begins: bytes
) -> None:
    answer = client.get(f"{finished_job()}/{result}", params={"segments": 3})
    assert answer.headers["Content-Type"] == media_type
    assert answer.headers["Content-Disposition"].startswith("attachment; filename=")
    assert answer.content.startswith(begins)


def test_parts_are_a_file_per_segment_and_closed_if_they_are_for_printing(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    cases = [
        ("stl", {}, True),
        ("stl", {"capped": "false"}, False),
        ("obj", {}, False),
        ("obj", {"capped": "true"}, True),
    ]
    for form, query, is_closed in cases:
        data = client.get(f"{path}/parts.zip", params={"segments": 3, "part_format": form, **query}).content
        archive = zipfile.ZipFile(io.BytesIO(data))
        *names, last = archive.namelist()
        assert (names, last) == ([f"segment_{number}.{form}" for number in range(3)], "parts.json")
        parts = [trimesh.load(io.BytesIO(archive.read(name)), file_type=form) for name in names]
        assert [part.is_watertight for part in parts] == [is_closed] * 3


def test_the_materials_of_obj_are_in_the_file_that_it_names(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path, query = finished_job(), {"segments": 3, "name": "1:left wheel"}
    model, colors = (client.get(f"{path}/model.{kind}", params=query) for kind in ("obj", "mtl"))
    assert re.findall("^mtllib (.*)$", model.text, re.MULTILINE) == ["model.mtl"]
    assert 'filename="model.mtl"' in colors.headers["Content-Disposition"]
    used = ["segment_0", "left_wheel", "segment_2"]
    assert re.findall("^usemtl (.*)$", model.text, re.MULTILINE) == used
    assert re.findall("^newmtl (.*)$", colors.text, re.MULTILINE) == used
    archive = zipfile.ZipFile(io.BytesIO(client.get(f"{path}/model.obj.zip", params=query).content))
    assert {name: archive.read(name) for name in archive.namelist()} == {
        "model.obj": model.content,
        "model.mtl": colors.content,
    }


def test_colours_of_ply_are_those_of_vertices_unless_the_request_says_otherwise(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    for query, is_divided in (({}, True), ({"colors": "vertices"}, True), ({"colors": "faces"}, False)):
        header = client.get(f"{path}/model.ply", params=query).content.partition(b"end_header")[0]
        assert (b"source_vertex" in header) == is_divided
    problem(client.get(f"{path}/model.ply", params={"colors": "edges"}), 422, "invalid_request")


def test_objects_of_3mf_are_closed_unless_the_request_says_otherwise(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    for query, is_closed in (({}, True), ({"capped": "true"}, True), ({"capped": "false"}, False)):
        data = client.get(f"{path}/model.3mf", params={"segments": 3, **query}).content
        scene = trimesh.load(io.BytesIO(data), file_type="3mf")
        assert [part.is_watertight for part in scene.geometry.values()] == [is_closed] * 3


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


def test_every_option_of_a_writer_is_a_query_parameter() -> None:
    assert {option for writer in MODELS.values() for option in writer.options} == {"names", "part_colors", *OPTIONS}


def test_a_mesh_in_inches_is_in_millimetres_as_3mf_and_in_centimetres_on_request(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job(unit="in", up="y")
    report = client.get(path).json()["mesh"]["report"]
    assert (report["unit"], report["up"], report["shown_up"]) == ("inch", "y", "y")
    extents = [high - low for low, high in zip(report["lower"], report["upper"], strict=True)]
    whole = trimesh.load_scene(io.BytesIO(client.get(f"{path}/model.3mf").content), file_type="3mf")
    assert whole.extents.tolist() == pytest.approx([25.4 * extents[axis] for axis in (0, 2, 1)], rel=1e-5)
    part = client.get(f"{path}/model.ply", params={"unit": "centimeter"}).content
    shape = trimesh.load_mesh(io.BytesIO(part), file_type="ply", process=False)
    assert shape.extents.tolist() == pytest.approx([2.54 * extent for extent in extents], rel=1e-5)
    problem(client.get(f"{path}/model.ply", params={"unit": "mile"}), 422, "invalid_parameters")


def test_a_mesh_whose_unit_nobody_said_cannot_be_converted(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    assert "not known" in str(problem(client.get(f"{path}/model.obj?unit=mm"), 422, "invalid_parameters")["detail"])
    assert "not known" in str(problem(client.get(f"{path}/parts.zip?up=z"), 422, "invalid_parameters")["detail"])


def test_the_materials_of_an_obj_set_come_back_as_they_were(
    client: httpx.Client, settings: Settings, store: JobStore
) -> None:
    library = b"newmtl paint\nKd 1 0 0\nmap_Kd a.png\n"
    mesh = b"mtllib a.mtl\nusemtl paint\n" + b"".join(b"v %d %d %d\n" % (x, x % 2, x // 2) for x in range(5))
    files = [("a.obj", mesh + b"f 1 2 3\nf 2 3 4\nf 3 4 5\n"), ("a.mtl", library), ("a.png", b"\x89PNG")]
    answer = client.post("/v1/jobs", files=[("mesh", file) for file in files])
    perform(store, settings, answer.json()["id"], lambda *_: None)
    path = answer.headers["Location"]
    kept = zipfile.ZipFile(io.BytesIO(client.get(f"{path}/model.obj.zip", params={"keep": "all"}).content))
    assert kept.read("a.mtl") == library
    assert kept.read("a.png") == b"\x89PNG"
    assert b"usemtl paint" in kept.read("model.obj")


def test_parts_can_be_asked_for_by_the_short_name_of_their_format(
    client: httpx.Client, finished_job: Callable[..., str]
) -> None:
    path = finished_job()
    short, long = (client.get(f"{path}/parts.zip", params={name: "glb"}) for name in ("format", "part_format"))
    assert short.status_code == 200
    assert short.content == long.content
    assert all(name.endswith(".glb") for name in zipfile.ZipFile(io.BytesIO(short.content)).namelist())
