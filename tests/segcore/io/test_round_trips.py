"""From every input format to every output format: other programs read each label on its face."""

import io
import json
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pygltflib
import pytest
import trimesh
from scipy.spatial.transform import Rotation

from helpers.files.blender_program import blender_reads, needs_blender
from helpers.files.written import json_of, labels_of_runs, members, written
from helpers.node.programs import install, run
from segcore.hierarchy import Hierarchy
from segcore.io import FORMATS, read_mesh
from segcore.io.palette import color_bytes
from segcore.mesh import Mesh, face_normals_and_areas

SEGMENTS = 5
OUTPUTS = {
    "glb": ("glb", {}),
    "levels.glb": ("glb", {"all_levels": True, "features": True}),
    "ply": ("ply", {}),
    "obj": ("obj", {}),
    "3mf": ("3mf", {"capped": False}),
    "stl.zip": ("zip", {"part_format": "stl", "capped": False}),
    "obj.zip": ("zip", {"part_format": "obj"}),
}
# Metres with y up become millimetres with z up, and the reverse; the other formats do not name both.
TO_3MF = 1000.0 * np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
CONVERTED = {("glb", "3mf"): TO_3MF, ("gltf", "3mf"): TO_3MF, ("3mf", "glb"): np.linalg.inv(TO_3MF)}
Parts = dict[int, np.ndarray]  # (F, 3, 3) the corners of the faces of each label


@dataclass(frozen=True)
class Written:
    """A file of another program, read, labelled and written again."""

    source: str  # the input format
    kind: str  # of OUTPUTS
    paths: dict[Path, int]  # the files, and the label of each file of a part
    expected: Parts


def knot() -> tuple[np.ndarray, np.ndarray]:
    """A twisted ring whose faces are in no particular order, exact in float32."""
    ring = trimesh.creation.torus(1.0, 0.3, 12, 8)
    order = np.random.default_rng(5).permutation(len(ring.faces))
    return (ring.vertices * [1, 2, 0.5] + 0.1).astype(np.float32).astype(np.float64), ring.faces[order]


def file_of(kind: str, vertices: np.ndarray, faces: np.ndarray) -> bytes:
    """The file as trimesh writes it."""
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    if kind == "gltf":
        return trimesh.exchange.gltf.export_gltf(trimesh.Scene(mesh), merge_buffers=True, embed_buffers=True)[
            "model.gltf"
        ]
    data = mesh.export(file_type=kind)
    return data.encode() if isinstance(data, str) else data


def hierarchy_of(mesh: Mesh) -> Hierarchy:
    """Random labels 0..4: each cut splits one label from the rest."""
    label = np.random.default_rng(1).integers(0, SEGMENTS, len(mesh.faces))
    leaves = np.minimum(2 * np.arange(SEGMENTS) + 1, 2 * SEGMENTS - 2)
    splits = np.concatenate([[0], 2 * np.arange(SEGMENTS - 2) + 2])
    areas = face_normals_and_areas(mesh.corners)[1]
    area, count = (np.bincount(leaves[label], weights, 2 * SEGMENTS - 1) for weights in (areas, None))
    for split in reversed(range(SEGMENTS - 1)):
        for sums in (area, count):
            sums[splits[split]] = sums[2 * split + 1] + sums[2 * split + 2]
    return Hierarchy(
        split_node=splits.astype(np.int32),
        cut_value=np.arange(SEGMENTS - 1) / 2,
        area=area,
        face_count=count.astype(np.int32),
        face_leaf=leaves[label].astype(np.int32),
        automatic_segments=SEGMENTS,
    )


@pytest.fixture(scope="module")
def outputs(tmp_path_factory: pytest.TempPathFactory) -> list[Written]:
    folder = tmp_path_factory.mktemp("round_trips")
    return [trip for source in FORMATS for trip in round_trips(source, folder)]


def round_trips(source: str, folder: Path) -> Iterator[Written]:
    vertices, faces = knot()
    mesh = read_mesh(io.BytesIO(file_of(source, vertices, faces)), appearance=True)
    np.testing.assert_allclose(mesh.corners, vertices[faces], rtol=0, atol=1e-6)
    hierarchy = hierarchy_of(mesh)
    labels = hierarchy.labels(SEGMENTS)
    for kind, (writer, options) in OUTPUTS.items():
        placed = vertices @ CONVERTED.get((source, writer), np.eye(3)).T
        expected = {label: placed[faces][labels == label] for label in range(SEGMENTS)}
        data = written(writer, mesh, hierarchy, SEGMENTS, **options)
        files = members(data) if writer == "zip" else {kind: data}
        files.pop("parts.json", None)
        paths = {folder / f"{source}.{name}": label for label, name in enumerate(files)}
        for path, content in zip(paths, files.values(), strict=True):
            path.write_bytes(content)
        yield Written(source, kind, paths, expected)


def assert_same(found: Parts, trip: Written, reader: str) -> None:
    """Every face has its position and is in input order within its label."""
    assert sorted(found) == sorted(trip.expected), (reader, trip.source, trip.kind)
    for label, corners in trip.expected.items():
        faces = np.asarray(found[label], dtype=np.float64).reshape(-1, 3, 3)
        assert faces.shape == corners.shape, (reader, trip.source, trip.kind, label)
        tolerance = 4e-6 * np.abs(corners).max()
        trial = f"{reader} {trip.source} {trip.kind}"
        np.testing.assert_allclose(faces, corners, rtol=0, atol=tolerance, err_msg=trial)


def label_of(name: str) -> int:
    return int(name.replace("_", " ").removeprefix("segment "))


def by_color(corners: np.ndarray, colors: np.ndarray) -> Parts:
    """Faces by the label of their colour, (F, 3) bytes; three.js stores colours as bytes of linear light."""
    distance = np.abs(color_bytes(SEGMENTS)[None].astype(int) - colors[:, None]).max(axis=2)
    assert (distance.min(axis=1) <= 3).all()
    return {label: corners[distance.argmin(axis=1) == label] for label in range(SEGMENTS)}


def with_trimesh(trip: Written) -> Parts:
    if trip.kind.endswith(".zip"):
        return {label: trimesh.load_mesh(path, process=False).triangles for path, label in trip.paths.items()}
    (path,) = trip.paths
    if trip.kind == "ply":
        mesh = trimesh.load_mesh(path, process=False)
        return by_color(mesh.triangles, mesh.visual.face_colors[:, :3])
    scene = trimesh.load_scene(path, process=False, **({"split_objects": True} if trip.kind == "obj" else {}))
    found = {}
    for node in scene.graph.nodes_geometry:
        transform, name = scene.graph[node]
        found[label_of(node if trip.kind != "obj" else name)] = (
            scene.geometry[name].copy().apply_transform(transform).triangles
        )
    return found


def with_meshio(trip: Written) -> Parts | None:
    """None if meshio cannot read the labels: it ignores groups of OBJ and properties of faces of PLY."""
    if not trip.kind.endswith(".zip"):
        return None
    found = {label: meshio.read(path) for path, label in trip.paths.items()}
    return {label: mesh.points[mesh.cells_dict["triangle"]] for label, mesh in found.items()}


def with_pygltflib(trip: Written) -> Parts | None:
    if not trip.kind.endswith("glb"):
        return None
    (path,) = trip.paths
    asset, found = pygltflib.GLTF2().load(path), {}
    root = asset.nodes[0]
    turn = Rotation.from_quat(root.rotation or [0, 0, 0, 1]).as_matrix() * (root.scale or [1, 1, 1])
    for node in asset.nodes:
        if node.mesh is not None:
            (primitive,) = asset.meshes[node.mesh].primitives
            points, indices = (
                accessor_of(asset, entry) for entry in (primitive.attributes.POSITION, primitive.indices)
            )
            found[node.extras["label"]] = (points.reshape(-1, 3) @ turn.T)[indices]
    return found


def accessor_of(asset: pygltflib.GLTF2, index: int) -> np.ndarray:
    accessor = asset.accessors[index]
    view = asset.bufferViews[accessor.bufferView]
    dtype, width = ("<f4", 3) if accessor.type == "VEC3" else ("<u4", 1)
    begin = (view.byteOffset or 0) + (accessor.byteOffset or 0)
    return np.frombuffer(asset.binary_blob(), dtype, width * accessor.count, begin)


@pytest.mark.parametrize("reader", [with_trimesh, with_meshio, with_pygltflib])
def test_programs_in_python_find_every_label_on_its_face(outputs: list[Written], reader: Any) -> None:
    found = [(trip, reader(trip)) for trip in outputs]
    assert sum(parts is not None for _, parts in found) >= len(FORMATS)
    for trip, parts in found:
        if parts is not None:
            assert_same(parts, trip, reader.__name__)


@pytest.mark.parametrize(("source", "kind"), [*product(FORMATS, ("seg", "npy", "json"))])
def test_labels_alone_are_those_of_the_faces_of_the_file(source: str, kind: str) -> None:
    mesh = read_mesh(io.BytesIO(file_of(source, *knot())))
    hierarchy = hierarchy_of(mesh)
    data = written(kind, mesh, hierarchy, SEGMENTS)
    found = {
        "seg": lambda: [int(line) for line in data.splitlines()],
        "npy": lambda: np.load(io.BytesIO(data), allow_pickle=False).tolist(),
        "json": lambda: labels_of_runs(json_of(data)),
    }[kind]()
    assert found == hierarchy.labels(SEGMENTS).tolist()


@pytest.mark.timeout(300)
def test_three_js_and_gltf_transform_find_every_label_on_its_face(outputs: list[Written], tmp_path: Path) -> None:
    script = install("three", tmp_path) / "read.mjs"
    paths = [str(path) for trip in outputs for path in trip.paths]
    answer = json.loads(run(script, [], json.dumps(paths)))
    for trip in outputs:
        assert_same(with_three(trip, answer["parts"]), trip, "three.js")
        if trip.kind == "levels.glb":
            (path,) = map(str, trip.paths)
            names, ids = answer["features"][path]["names"], answer["features"][path]["ids"]
            assert {name: [names[row] for row in rows] for name, rows in ids.items()} == {
                f"segment {label}": [f"segment {label}"] for label in range(SEGMENTS)
            }


def with_three(trip: Written, parts: dict[str, list[dict[str, Any]]]) -> Parts:
    if trip.kind.endswith(".zip"):
        return {label: np.array(parts[str(path)][0]["corners"]) for path, label in trip.paths.items()}
    (path,) = trip.paths
    if trip.kind == "ply":
        (part,) = parts[str(path)]
        colors = np.array(part["colors"])
        if colors.dtype.kind == "f":  # Blender: fractions at every corner
            colors = np.round(255 * colors.reshape(-1, 3, 3)[:, 0]).astype(int)
        else:
            colors = colors[:, None] >> [16, 8, 0] & 255
        return by_color(np.array(part["corners"]).reshape(-1, 3, 3), colors)
    return {label_of(part["name"]): np.array(part["corners"]) for part in parts[str(path)]}


@needs_blender
@pytest.mark.timeout(300)
def test_blender_finds_every_label_on_its_face(outputs: list[Written], tmp_path: Path) -> None:
    trips = [trip for trip in outputs if trip.kind != "3mf"]  # which it does not read
    answer = blender_reads([path for trip in trips for path in trip.paths], tmp_path)
    for trip in trips:
        assert_same(with_three(trip, answer), trip, "Blender")
