"""Every cell of the table of formats in the README is true."""

import io
import json
import re
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from helpers.files.hierarchies import two_strips
from helpers.files.polygon_soups import read, read_or_none
from helpers.files.samples import BINARY_STL, DRESSED, SAMPLES
from helpers.files.written import labels_of_runs, members, written
from helpers.simulation.usd import usd_content
from segcore.appearance import Appearance
from segcore.errors import UnsupportedFormat
from segcore.io import FORMATS, read_mesh
from segcore.io.result import read_result
from segcore.io.writing import WRITERS, writer_for
from segcore.mesh import Mesh

README = Path(__file__).parents[3] / "README.md"
SEGMENTS = 3
COLUMNS = ("read", "written", "look", "groups", "names", "segments are")
USD = ("usdc", "usdz")
KEYS = {form.title: name for name, form in FORMATS.items()}  # of FORMATS, by the name in the table


def table() -> dict[str, list[str]]:
    section = README.read_text(encoding="utf-8").partition("### Formats\n")[2].partition("\n### ")[0]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line[:1] == "|"]
    return {name: row[1:] for row in cells[2:] for name in row[0].split(", ")}


def kind_of(name: str) -> str:
    """The key of FORMATS or of WRITERS."""
    return KEYS.get(name, name.strip("."))


def dressed() -> tuple[Mesh, object]:
    """Two strips with every kind of attribute that an appearance can have."""
    mesh, hierarchy = two_strips()
    count = len(mesh.vertices)
    look = Appearance(
        normals=np.tile(np.array([0, 0, 1], np.float32), (count, 1)),
        uvs=np.zeros((count, 2), np.float32),
        colors=np.full((count, 4), 9, np.uint8),
        face_group=np.array([0, 1, 0, 1], np.int32),
        group_names=("left wheel", "axle"),
    )
    return Mesh(mesh.vertices, mesh.faces, None, look), hierarchy


def out(kind: str, **options: object) -> bytes:
    return written(kind, *dressed(), SEGMENTS, **options)


def glb_document(data: bytes) -> dict:
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + length])


def how_read(kind: str) -> str:
    if kind == "cleave":
        with pytest.raises(UnsupportedFormat, match="cleave convert"):
            read(out(kind))
        return "by `convert`" if len(read_result(io.BytesIO(out(kind))).mesh.faces) == 4 else "no"
    files = SAMPLES[kind] if kind in FORMATS else [out(kind)]
    return "yes" if all(read_or_none(data) is not None for data in files) else "no"


def files_of_parts() -> list[str]:
    return [name for name in members(out("zip")) if name != "parts.json"]


def how_written(kind: str) -> str:
    try:
        return "yes" if writer_for(f"a.{kind}") is WRITERS[kind] and out(kind) else "no"
    except UnsupportedFormat:
        return "in `.zip`" if all(name.endswith(f".{kind}") for name in files_of_parts()) else "no"


def how_the_look_is_kept(kind: str) -> str:
    wanted = {"normals", "uvs", "colors"}
    kept = []
    if kind in FORMATS and all(wanted <= look_of(data) for data in DRESSED[kind][:1]):
        kept.append("read")
    if kind == "cleave":
        kept += (
            ["read", "written"] if wanted == set(read_result(io.BytesIO(out(kind))).mesh.appearance.row_arrays) else []
        )
    elif kind == "glb":
        (first, *_) = glb_document(out(kind))["meshes"]
        kept += ["written"] if {"NORMAL", "TEXCOORD_0", "_COLOR_0"} <= set(first["primitives"][0]["attributes"]) else []
    elif kind in USD:
        properties = set(usd_content(out(kind), kind).properties)
        kept += ["normals and texture coordinates written"] if {"primvars:normals", "primvars:st"} <= properties else []
    elif kind in FORMATS and kind in WRITERS and wanted <= look_of(out(kind)):
        kept.append("written")
    return ", ".join(kept) or "no"


def look_of(data: bytes) -> set[str]:
    look = read_mesh(io.BytesIO(data), appearance=True).appearance
    return set(look.row_arrays) if look else set()


def how_groups_are_kept(kind: str) -> str:
    kept = []
    if kind in FORMATS and has_groups(DRESSED[kind][0]):
        kept.append("read (text)" if kind == "stl" and not has_groups(BINARY_STL) else "read")
    places: dict[str, Callable[[str], str]] = {
        r"# group of the input: left wheel\n": lambda _: "written (comments)",
        r'<metadata name="Description">groups of the input: left wheel': lambda _: "written (descriptions)",
        r'"extras":\{[^}]*"groups":\["left wheel"': lambda _: "written (extras)",
    }
    if kind == "cleave":
        kept += ["read", "written"] if read_result(io.BytesIO(out(kind))).mesh.appearance.face_group is not None else []
    elif kind in WRITERS:
        kept += [say(text) for place, say in places.items() for text in texts_of(kind) if re.search(place, text)]
    return ", ".join(kept) or "no"


def has_groups(data: bytes) -> bool:
    look = read_mesh(io.BytesIO(data), appearance=True).appearance
    return look is not None and look.face_group is not None


def texts_of(kind: str, **options: object) -> list[str]:
    data = out(kind, **options)
    files = members(data).values() if data.startswith(b"PK") else [data]
    return [file.decode("latin-1") for file in files]


def how_segments_are_called(kind: str) -> str:
    given = {"names": {1: "wheel"}}
    if kind in USD:
        return "yes" if "wheel" in usd_content(out(kind, **given), kind).families["materialBind"] else "no"
    if kind == "stl":
        return "in names of files" if "segment_1_wheel.stl" in members(out("zip", **given)) else "no"
    if kind not in ("glb", "obj", "ply", "3mf"):
        return "no"
    if kind == "ply":
        return "in comments" if "comment label 1 is wheel\n" in texts_of(kind, **given)[0] else "no"
    return (
        "yes"
        if read_mesh(io.BytesIO(out(kind, **given)), appearance=True).appearance.group_names.count("wheel")
        else "no"
    )


def labels() -> np.ndarray:
    return two_strips()[1].labels(SEGMENTS)


def ply_column(*names: str) -> np.ndarray:
    """(F, N) properties of the faces, as trimesh reads them."""
    raw = trimesh.load(io.BytesIO(out("ply")), file_type="ply", process=False).metadata["_ply_raw"]["face"]["data"]
    return np.stack([raw[name].ravel() for name in names], axis=1)


def colors_of_ply_corners() -> np.ndarray:
    """(F, 3, 4) the colours of the vertices of the faces, which agree within a face."""
    mesh = read_mesh(io.BytesIO(out("ply")), appearance=True)
    colors = mesh.appearance.colors[mesh.faces]
    assert (colors == colors[:, :1]).all()
    return colors


def same_partition(colors: np.ndarray) -> bool:
    same = (colors[:, None] == colors[None]).all(axis=2)
    return bool((same == (labels()[:, None] == labels()[None])).all())


def are_nested() -> bool:
    nodes = glb_document(out("glb"))["nodes"]
    below = [child for node in nodes for child in node.get("children", [])]
    return sorted(below) == list(range(1, 2 * SEGMENTS - 1)) and sum("mesh" in node for node in nodes) == SEGMENTS


def extension(name: str, entries: str, **options: bool) -> int:
    """The number of entries of an extension of a GLB file."""
    return len(glb_document(out("glb", **options))["extensions"][name][entries])


def has_all_levels(kind: str) -> bool:
    families = usd_content(out(kind), kind).families.values()
    return {len(parts) for parts in families} >= set(range(2, SEGMENTS + 1))


def labels_alone(kind: str) -> bool:
    data = out(kind)
    found = {
        "seg": lambda: [int(line) for line in data.splitlines()],
        "npy": lambda: np.load(io.BytesIO(data)).tolist(),
        "json": lambda: labels_of_runs(json.loads(data)),
    }[kind]()
    return found == labels().tolist()


CLAIMS: dict[str, dict[str, Callable[[], bool]]] = {
    "stl": {"files": lambda: len(files_of_parts()) == SEGMENTS},
    "ply": {
        "`label` of faces": lambda: ply_column("label").ravel().tolist() == labels().tolist(),
        "colours of vertices": lambda: same_partition(colors_of_ply_corners()[:, 0]),
        "colours of faces": lambda: same_partition(ply_column("red", "green", "blue")),
    },
    "obj": {
        "objects": lambda: re.findall("\no (.*)", out("obj").decode()) == [f"segment_{k}" for k in range(SEGMENTS)],
        "materials": lambda: out("mtl").decode().count("newmtl ") == SEGMENTS,
    },
    "glb": {
        "nested nodes": are_nested,
        "materials": lambda: len(glb_document(out("glb"))["materials"]) == SEGMENTS,
        "variants of materials": lambda: extension("KHR_materials_variants", "variants", all_levels=True) == SEGMENTS,
        "feature ids": lambda: extension("EXT_structural_metadata", "propertyTables", features=True) == 1,
    },
    "3mf": {"objects": lambda: len(trimesh.load(io.BytesIO(out("3mf")), file_type="3mf").geometry) == SEGMENTS},
    **{
        kind: {
            "subsets of faces for every level": lambda kind=kind: has_all_levels(kind),
            "materials": lambda kind=kind: len(usd_content(out(kind), kind).families["materialBind"]) == SEGMENTS,
        }
        for kind in USD
    },
    **{kind: {"labels of faces": lambda kind=kind: labels_alone(kind)} for kind in ("seg", "npy", "json")},
    "cleave": {"whole hierarchy": lambda: read_result(io.BytesIO(out("cleave"))).hierarchy.max_segments == SEGMENTS},
}


def what_segments_are(kind: str) -> str:
    return ", ".join(claim for claim, holds in CLAIMS.get(kind, {}).items() if holds())


PROOFS = dict(
    zip(
        COLUMNS,
        (
            how_read,
            how_written,
            how_the_look_is_kept,
            how_groups_are_kept,
            how_segments_are_called,
            what_segments_are,
        ),
        strict=True,
    )
)


def test_the_table_has_a_row_for_every_format() -> None:
    assert {kind_of(name) for name in table()} == set(FORMATS) | set(WRITERS) - {"zip", "mtl", "objzip"}
    assert {len(row) for row in table().values()} == {len(COLUMNS)}


@pytest.mark.parametrize("column", COLUMNS)
@pytest.mark.parametrize("name", table())
def test_a_cell_is_true(name: str, column: str) -> None:
    assert table()[name][COLUMNS.index(column)] == PROOFS[column](kind_of(name))
