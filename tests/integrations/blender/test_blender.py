"""The extension in Blender: the same labels as the API for every kind of mesh, and nothing is left of it."""

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import httpx
import numpy as np
import pytest

from cleave.settings import Settings
from helpers.blender.session import needs_blender, run_scenario
from helpers.servers import remembered_segmentations, serving, working
from integrations.blender.parts import unnamed
from integrations.blender_package import pack
from service.keys import key_digest, new_key
from worker.jobs.store.opening import open_folder

pytestmark = needs_blender

MODELS = ("table", "dumbbell", "head", "star", "stool")
STRETCH = {"star": np.array([0.4, 0.4, 1.0])}  # its scale is -1, 1, 2.5: the shape without size and mirror image


@pytest.fixture(scope="module")
def http(tmp_path_factory: pytest.TempPathFactory, queue_url: str) -> Iterator[httpx.Client]:
    """A client of a service that requires a key."""
    key, data = new_key(), tmp_path_factory.mktemp("data")
    settings = Settings(data_dir=data, redis_url=queue_url, api_keys=f"artist:{key_digest(key)}")
    with remembered_segmentations(), working(open_folder(data), settings), serving(settings) as client:
        client.headers["Authorization"] = f"Bearer {key}"
        yield client


@pytest.fixture(scope="module")
def seen(http: httpx.Client, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("blender")
    key = http.headers["Authorization"].removeprefix("Bearer ")
    return run_scenario(pack(folder), str(http.base_url).rstrip("/"), key, folder)


@pytest.fixture(scope="module")
def of_api(seen: dict[str, Any], http: httpx.Client) -> dict[str, dict[str, list[int]]]:
    """The labels of the triangles that the API gives for an OFF file, by models and levels."""
    found: dict[str, dict[str, list[int]]] = {}
    for name in MODELS:
        geometry = seen["several_objects"]["models"][name]["geometry"]
        vertices = np.array(geometry["vertices"])
        vertices = (vertices * STRETCH.get(name, 1.0)).astype(np.float32)
        job = posted(http, vertices, geometry["polygons"])
        asked: dict[str, dict[str, float]] = {"automatic": {}, "finest": {"granularity": 1}}
        asked |= {str(k): {"segments": k} for k in (1, 2, 3, 5) if k <= job["max_segments"]}
        found[name] = {level: labels_of(http, job, query) for level, query in asked.items()}
    return found


def posted(http: httpx.Client, vertices: np.ndarray, polygons: list[list[int]]) -> dict[str, Any]:
    """Return the job of a mesh, sent as OFF, when it has succeeded."""
    lines = ["OFF", f"{len(vertices)} {len(polygons)} 0"]
    lines += [" ".join(map(repr, point)) for point in vertices.tolist()]
    lines += [" ".join(map(str, [len(polygon), *polygon])) for polygon in polygons]
    headers = {"Content-Type": "model/off", "Prefer": "wait=60"}
    job: dict[str, Any] = http.post("/v1/jobs", content="\n".join(lines) + "\n", headers=headers).json()
    return job


def labels_of(http: httpx.Client, job: dict[str, Any], query: dict[str, float]) -> list[int]:
    labels: list[int] = http.get(f"/v1/jobs/{job['id']}/labels", params=query).json()["labels"]
    return labels


def of_largest_area(geometry: dict[str, Any], labels: list[int]) -> list[int]:
    """The label of each polygon that has the largest area of its triangles, which are fans."""
    points, following = np.array(geometry["vertices"]), iter(labels)
    found = []
    for polygon in geometry["polygons"]:
        areas: dict[int, float] = {}
        a = points[polygon[0]]
        for second, third in pairwise(polygon[1:]):
            label = next(following)
            area = float(np.linalg.norm(np.cross(points[second] - a, points[third] - a)))
            areas[label] = areas.get(label, 0.0) + area
        found.append(max(areas, key=lambda label: areas[label]))
    assert next(following, None) is None
    return found


@pytest.mark.parametrize("name", MODELS)
def test_every_face_has_the_label_of_the_api(
    seen: dict[str, Any], of_api: dict[str, dict[str, list[int]]], name: str
) -> None:
    model = seen["several_objects"]["models"][name]
    assert len(set(model["labels"])) > 1
    assert model["labels"] == of_largest_area(model["geometry"], of_api[name]["automatic"])
    assert model["face_sets"] == [label + 1 for label in model["labels"]]


@pytest.mark.parametrize("name", MODELS)
def test_the_parts_are_those_of_the_object_in_the_world(seen: dict[str, Any], http: httpx.Client, name: str) -> None:
    """With rotation, place and size, which may change the order of parts that are alike."""
    model = seen["several_objects"]["models"][name]
    geometry = model["geometry"]
    job = posted(http, np.array(geometry["in the world"]), geometry["polygons"])
    labels = of_largest_area(geometry, labels_of(http, job, {}))
    pairs = set(zip(model["labels"], labels, strict=True))
    assert len(pairs) == len(set(labels)) == len(set(model["labels"]))


@pytest.mark.parametrize("name", MODELS)
def test_other_levels_are_those_of_the_api_without_another_job(
    seen: dict[str, Any], of_api: dict[str, dict[str, list[int]]], name: str
) -> None:
    levels = seen["several_objects"]["levels"]
    geometry = seen["several_objects"]["models"][name]["geometry"]
    for level, labels in of_api[name].items():
        if level != "automatic":
            assert levels[level][name] == of_largest_area(geometry, labels)
    assert levels["1000"][name] == levels["finest"][name]
    assert len(set(levels["2"][name])) == 2


def test_each_mesh_is_sent_once(seen: dict[str, Any]) -> None:
    """Neither another level nor another place or direction of an object makes a job; another shape does."""
    assert seen["several_objects"]["jobs"] == [0, len(MODELS), len(MODELS), len(MODELS) + 1]


def test_modifiers_and_n_gons_are_among_the_models(seen: dict[str, Any]) -> None:
    sizes = {
        name: {len(polygon) for polygon in seen["several_objects"]["models"][name]["geometry"]["polygons"]}
        for name in MODELS
    }
    assert max(sizes["table"]) == 20
    assert sizes["star"] == {3}
    assert sizes["head"] == {3, 4}


def test_materials_and_vertex_groups_are_those_of_the_labels(seen: dict[str, Any]) -> None:
    for name in MODELS:
        model = seen["several_objects"]["models"][name]
        count = max(model["labels"]) + 1
        expected = unnamed(np.zeros(0, dtype=np.int32), count)
        assert model["material"] == model["labels"]
        assert [entry.partition(" ")[2] for entry in model["materials"]] == expected.names
        assert np.allclose(model["colors"], expected.colors, atol=1e-6)
        assert list(model["groups"]) == expected.names
        for label, group in enumerate(expected.names):
            polygons = zip(model["labels"], model["geometry"]["polygons"], strict=True)
            vertices = {vertex for found, polygon in polygons if found == label for vertex in polygon}
            assert set(model["groups"][group]) == vertices


def test_undo_restores_everything_and_redo_computes_nothing(seen: dict[str, Any]) -> None:
    undone = seen["undone"]
    assert [name for name in undone["separated"] if name.startswith("table")] == [
        f"table segment {label}" for label in range(5)
    ]
    assert undone["objects"] == sorted(MODELS)
    assert undone["after"] == undone["before"]
    assert undone["before"]["materials"] == ["own"]
    assert undone["before"]["record"] is None
    assert undone["redone"] == [3, 0]  # parts, jobs


def test_a_second_division_replaces_the_first(seen: dict[str, Any]) -> None:
    first, second, labels = seen["repeated"]["first"], seen["repeated"]["second"], seen["repeated"]["labels"]
    assert (len(first["materials"]), len(second["materials"])) == (6, 3)
    assert second["materials"][0] == first["materials"][0]  # the user's
    assert second["material"] == [label + 1 for label in labels]
    assert list(second["groups"]) == ["segment 0", "segment 0.001", "segment 1"]
    assert second["groups"]["segment 0"] == []  # the user's


def test_separate_objects_are_the_parts(seen: dict[str, Any]) -> None:
    separated = seen["separated"]
    objects = separated["objects"]
    for name, base in (("table", "table"), ("twin", "table"), ("stool", "stool")):
        labels, centres = separated["labels"][base], separated["centres"][base]
        made = {key: entry for key, entry in objects.items() if key.startswith(f"{name} ")}
        assert sorted(made) == [f"{name} segment {label}" for label in sorted(set(labels))]
        for label in set(labels):
            entry = made[f"{name} segment {label}"]
            assert entry["labels"] == [label] * labels.count(label)
            expected = [centre for centre, found in zip(centres, labels, strict=True) if found == label]
            assert entry["centres"] == expected  # in their order
            assert entry["selected"]
    assert objects["other"]["labels"] == separated["labels"]["table"]  # not selected, with the same mesh


def test_separate_objects_keep_shape_keys_and_one_keeps_loose_edges(seen: dict[str, Any]) -> None:
    stools = [entry for name, entry in sorted(seen["separated"]["objects"].items()) if name.startswith("stool")]
    assert [entry["loose"] for entry in stools] == [1, 0, 0, 0]
    assert all(entry["keys"] == ["Basis", "taller"] for entry in stools)
    assert all(entry["matrix"] == stools[0]["matrix"] for entry in stools)
    before, after = seen["separated"]["meshes and keys"]
    assert [a - b for a, b in zip(after, before, strict=True)] == [
        5 + 5 + 3,
        3,
    ]  # of table, twin and stool, whose whole is removed


def test_corrected_parts_come_with_their_names(seen: dict[str, Any]) -> None:
    corrected = seen["corrected"]
    assert "were not corrected on the server" in corrected["early"]
    assert corrected["labels"] == of_largest_area(corrected["geometry"], corrected["api"]["labels"])
    assert set(corrected["labels"]) == {0, 1, 2, 3}
    assert next(iter(corrected["groups"])) == "board"
    assert corrected["materials"][0].endswith(" board")
    assert corrected["objects"] == ["table board", "table leg", "table segment 2", "table segment 3"]


def test_parts_of_another_mesh_are_not_fetched(seen: dict[str, Any]) -> None:
    assert "was not segmented on" in seen["corrected"]["never sent"]
    assert "has other faces than those that were sent" in seen["corrected"]["changed"]


@pytest.mark.parametrize(
    ("what", "sentence"),
    [
        ("nothing", "Select an object with a mesh"),
        ("no faces", "empty has no faces: deselect it."),
        ("name taken", "has another attribute with the name cleave_part: rename it."),
        ("offline", "enable Allow Online Access"),
        ("no server", "No answer from 127.0.0.1:1"),
        ("no python", "/nowhere/python cannot be started"),
    ],
)
def test_errors_say_what_to_do(seen: dict[str, Any], what: str, sentence: str) -> None:
    assert sentence in seen["refused"][what]
    assert "Traceback" not in seen["refused"][what]


def test_only_object_mode_is_accepted(seen: dict[str, Any]) -> None:
    assert "Switch to Object Mode" in seen["corrected"]["edit mode"]


def test_this_machine_finds_the_same_parts(seen: dict[str, Any]) -> None:
    assert seen["first place"] == "LOCAL"
    here = seen["here"]
    assert here["labels"] == seen["several_objects"]["models"]["table"]["labels"]
    assert here["attributes"] == ["cleave_part"]
    assert (here["materials"], here["groups"], here["record"]) == ([], {}, None)


def test_the_documented_script_prints_the_sizes_of_parts(seen: dict[str, Any]) -> None:
    documented = seen["documented"]
    (sizes,) = documented["said"]
    assert list(sizes) == ["0", "1", "2", "3", "4"]
    assert sum(sizes.values()) == len(documented["material"])
    assert documented["materials"] == []
    assert len(documented["groups"]) == 5


def test_work_beside_the_interface_ends_as_it_should(seen: dict[str, Any]) -> None:
    found = seen["beside_the_interface"]
    assert {name: ends for name, (_, ends, _) in found.items()} == {
        "done": ["FINISHED"],
        "stopped": ["CANCELLED"],
        "failed": ["CANCELLED"],
        "changed": ["CANCELLED"],
    }
    assert all(during[:2] == [["PASS_THROUGH"]] * 2 for during, _, _ in found.values())
    said = {name: reports for name, (_, _, reports) in found.items()}
    assert said["stopped"] == [["INFO", "Canceled."]]
    assert said["failed"] == [["ERROR", "No luck: try again."]]
    assert said["changed"][0][1].startswith("The mesh was changed while it was segmented")


def test_the_extension_leaves_nothing(seen: dict[str, Any]) -> None:
    assert seen["installed"]["operators"] == ["cleave_fetch", "cleave_segment"]
    assert seen["installed"]["menu"] == seen["before"]["menu"] + 1
    assert seen["removed"] == seen["before"]
