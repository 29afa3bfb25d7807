"""The table of formats in the README says what the readers and writers do."""

import io
from pathlib import Path

import numpy as np
import pytest
from trees import two_strips
from written import written

from segcore.appearance import Appearance
from segcore.io import FORMATS, read_mesh
from segcore.io.result import read_result
from segcore.io.writing import WRITERS
from segcore.mesh import Mesh

README = Path(__file__).parents[3] / "README.md"


def rows() -> dict[str, list[str]]:
    section = README.read_text().partition("### Formats\n")[2].partition("\n### ")[0]
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line[:1] == "|"]
    return {row[0]: row[1:] for row in cells[2:]}


def test_the_formats_that_are_read_and_written_are_those_of_the_table() -> None:
    table = rows()
    assert {name for name, row in table.items() if row[0] == "yes"} == {form.title for form in FORMATS.values()}
    written_names = {name for row in table if table[row][1] == "yes" for name in row.split(", ")}
    assert {name.strip(".").lower() for name in written_names} == set(WRITERS) - {"zip"}
    assert table["STL"][1] == "in `.zip`"


@pytest.mark.parametrize("kind", ["ply", "obj", "glb", "3mf", "cleave"])
def test_what_goes_round_is_what_the_table_says(kind: str) -> None:
    mesh, hierarchy = two_strips()
    count = len(mesh.vertices)
    look = Appearance(
        normals=np.tile(np.array([0, 0, 1], np.float32), (count, 1)),
        uvs=np.zeros((count, 2), np.float32),
        colors=np.full((count, 4), 9, np.uint8),
        face_group=np.zeros(4, np.int32),
        group_names=("wheel",),
    )
    data = io.BytesIO(written(kind, Mesh(mesh.vertices, mesh.faces, None, look), hierarchy))
    back = read_result(data).mesh.appearance if kind == "cleave" else read_mesh(data, appearance=True).appearance
    row = rows()[".cleave" if kind == "cleave" else FORMATS[kind].title]
    kept = set(back.row_arrays) if back else set()
    assert ("written" in row[2]) == ({"normals", "uvs"} <= kept)
    assert ("read" in row[3]) == (back is not None and back.face_group is not None)
