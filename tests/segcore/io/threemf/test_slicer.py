"""Slicer projects: volumes that are no part of the body are left out, whatever state the settings are in."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.polygon_soups import Soup, read, read_or_none
from helpers.files.samples import SQUARE
from helpers.files.slicer_projects import BAMBU, HEAD, PRUSA, TWO_SQUARES, bambu_project, prusa, prusa_project
from helpers.files.threemf import Model3MF
from segcore.errors import InvalidMesh, LimitExceeded
from segcore.io import ReadLimits


@pytest.mark.parametrize(
    ("metadata", "kind"),
    [
        ([("volume_type", "NegativeVolume")], "negative volume"),
        ([("volume_type", "ParameterModifier")], "modifier"),
        ([("modifier", "1"), ("volume_type", "ParameterModifier")], "modifier"),
        ([("modifier", "1")], "modifier"),
        ([("volume_type", "SupportBlocker")], "support blocker"),
        ([("volume_type", "SupportEnforcer")], "support enforcer"),
    ],
)
@pytest.mark.parametrize("name", [PRUSA, "Metadata/Slic3r_model.config"])
def test_triangles_of_volumes_that_are_no_part_of_the_body_are_left_out(
    metadata: list[tuple[str, str]], kind: str, name: str
) -> None:
    mesh = read(prusa_project(prusa(2, 3, ("name", "cut&#10;ter"), *metadata), name))
    assert mesh.faces.tolist() == SQUARE.polygons
    assert mesh.vertices.tolist() == [list(vertex) for vertex in SQUARE.vertices]
    assert mesh.notes == (f"1 volume that is no part of the body is left out: cut ter ({kind}).",)
    mesh = read(prusa_project(prusa(0, 1, *metadata), name))
    assert mesh.vertices.tolist() == [[x + 5, y, z] for x, y, z in SQUARE.vertices]
    assert mesh.notes == (f"1 volume that is no part of the body is left out: without a name ({kind}).",)


@pytest.mark.parametrize(
    "settings",
    [
        prusa(2, 3, ("volume_type", "ModelPart")),
        prusa(2, 3, ("volume_type", "a later invention")),
        prusa(2, 3, ("modifier", "0")),
        prusa(2, 3, ("modifier", "1"), ("volume_type", "ModelPart")),
        prusa(2, 4, ("volume_type", "NegativeVolume")),
        prusa(3, 2, ("volume_type", "NegativeVolume")),
        prusa(2, 3, ("volume_type", "NegativeVolume"), number=7),
        "<config/>",
    ],
)
def test_all_other_volumes_are_read(settings: str) -> None:
    mesh = read(prusa_project(settings))
    assert len(mesh.faces) == 4
    assert mesh.notes == ()


def test_components_that_are_no_part_of_the_body_are_left_out() -> None:
    kinds = ["negative_part", "normal_part", "modifier_part", "support_blocker", "normal_part", "support_enforcer"]
    mesh = read(bambu_project(kinds))
    expected = [[x + shift, y, z] for shift in (1, 4) for x, y, z in SQUARE.vertices]
    assert mesh.vertices.tolist() == expected
    assert mesh.structure.group.tolist() == [0, 0, 1, 1]
    assert mesh.notes == (
        "4 volumes that are no part of the body are left out: part 1 (negative volume), part 3 (modifier), "
        "part 4 (support blocker), part 6 (support enforcer).",
    )


def test_a_note_names_five_volumes() -> None:
    (note,) = read(bambu_project(["normal_part", *["modifier_part"] * 7])).notes
    assert note.startswith("7 volumes")
    assert note.endswith("part 6 (modifier) and 2 more.")


def test_parts_of_other_objects_do_not_matter() -> None:
    settings = f'{HEAD}<config><object id="8"><part id="1" subtype="negative_part"/></object></config>'
    assert len(read(bambu_project(["normal_part"], settings)).faces) == 2


def test_an_object_that_is_its_own_part_can_be_left_out() -> None:
    model = Model3MF()
    model.item(model.mesh(SQUARE))
    model.item(model.mesh(SQUARE))
    settings = f'{HEAD}<config><object id="2"><part id="2" subtype="negative_part"/></object></config>'
    assert len(read(model.package(**{BAMBU: settings})).faces) == 2


def test_a_project_without_a_body_is_refused_with_what_is_left_out() -> None:
    with pytest.raises(InvalidMesh, match=r"no item with triangles. .*part 1 \(modifier\)"):
        read(bambu_project(["modifier_part"]))


@pytest.mark.parametrize(
    "settings",
    [
        "",
        "not xml",
        prusa(2, 3, ("volume_type", "NegativeVolume"))[:-5],
        prusa("two", 3, ("volume_type", "NegativeVolume")),
        prusa("-2", 3, ("volume_type", "NegativeVolume")),
        prusa("1_0", 3, ("volume_type", "NegativeVolume")),
        prusa("9" * 5000, 3, ("volume_type", "NegativeVolume")),
        HEAD + '<!DOCTYPE config [<!ENTITY a "aa">]><config>&a;</config>',
        "<config>" + " " * 2**24 + "</config>",
    ],
)
def test_settings_that_are_damaged_or_too_large_are_ignored_and_noted(settings: str) -> None:
    mesh = read(prusa_project(settings))
    assert len(mesh.faces) == 4
    (note,) = mesh.notes
    assert "settings of the slicer in metadata/slic3r_pe_model.config are damaged" in note


def test_settings_count_as_unpacked_bytes() -> None:
    settings = "<config>" + " " * 100_000 + "</config>"
    with pytest.raises(LimitExceeded, match="max_uncompressed_bytes"):
        read(prusa_project(settings), limits=ReadLimits(max_uncompressed_bytes=100_000))


def test_a_wrong_vertex_is_refused_beside_a_volume_that_is_left_out() -> None:
    model = Model3MF()
    model.mesh(Soup(TWO_SQUARES.vertices, [(0, 1, 99), *TWO_SQUARES.polygons[1:]]))
    model.item(1)
    with pytest.raises(InvalidMesh, match="Triangle 0"):
        read(model.package(**{PRUSA: prusa(2, 3, ("volume_type", "NegativeVolume"))}))


@given(st.data())
def test_damaged_settings_give_a_mesh_or_a_typed_error(data: st.DataObject) -> None:
    settings = bytearray(prusa(2, 3, ("volume_type", "NegativeVolume"), ("name", "cutter")).encode())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(settings) - 1))
        settings[at : at + data.draw(st.integers(0, 3))] = data.draw(st.binary(max_size=2))
    mesh = read_or_none(prusa_project(bytes(settings)))
    assert mesh is not None
    assert 0 < len(mesh.faces) <= 4
