"""The groups and materials of a file: numbers of faces."""

import numpy as np
import pytest

from segcore import shapes
from segcore.errors import InvalidMesh
from segcore.mesh import Mesh
from segcore.structure import FileStructure, file_structure, numbered_runs


def test_runs_with_equal_keys_have_the_same_number_in_the_order_of_the_file() -> None:
    assert numbered_runs(["b", "a", None, "b"], [2, 1, 1, 1]).tolist() == [0, 0, 1, -1, 0]


def test_runs_without_faces_get_no_number() -> None:
    assert numbered_runs(["empty", "full"], [0, 2]).tolist() == [0, 0]


@pytest.mark.parametrize(("keys", "sizes"), [([], []), ([None, None], [2, 3]), (["empty"], [0])])
def test_faces_without_any_key_have_no_structure(keys: list[str | None], sizes: list[int]) -> None:
    assert numbered_runs(keys, sizes) is None
    assert file_structure(None, numbered_runs(keys, sizes)) is None


@pytest.mark.parametrize("numbers", [np.array([0, -2], np.int32), np.zeros((2, 1), np.int32)])
def test_numbers_that_are_no_list_from_minus_one_are_refused(numbers: np.ndarray) -> None:
    with pytest.raises(InvalidMesh, match="from -1"):
        FileStructure(group=numbers)


def test_a_mesh_refuses_the_structure_of_another_one() -> None:
    box = shapes.box()
    with pytest.raises(InvalidMesh, match="number of faces"):
        Mesh(box.vertices, box.faces, structure=FileStructure(material=np.zeros(11, np.int32)))
