"""The 3MF reader: every item of the build in its place, and no archive that unpacks to more than the limits."""

import struct
import zipfile
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.plain_readers import slow_3mf
from helpers.files.polygon_soups import read, read_or_none
from helpers.files.samples import SQUARE, THREEMF_SQUARE
from helpers.files.threemf import RELATIONSHIPS, TYPES, Model3MF, package, packages
from segcore.errors import InvalidMesh, LimitExceeded, UnsupportedFormat
from segcore.io import ReadLimits

MATERIAL = "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"
IDENTITY = [1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]


def square(**settings: str) -> Model3MF:
    model = Model3MF(**settings)
    model.mesh(SQUARE)
    return model


@given(packages())
def test_every_triangle_has_the_position_of_the_build(data: bytes) -> None:
    expected = slow_3mf(data)
    # Sums of products may cancel, so that a coordinate is as precise as the largest one.
    np.testing.assert_allclose(read(data).corners, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


def test_without_transforms_coordinates_are_exact_and_vertices_stay_shared() -> None:
    mesh = read(THREEMF_SQUARE)
    assert mesh.vertices.tolist() == [list(vertex) for vertex in SQUARE.vertices]
    assert mesh.faces.tolist() == SQUARE.polygons


@pytest.mark.parametrize(
    ("unit", "factor"),
    [("micron", 0.001), ("millimeter", 1), ("centimeter", 10), ("inch", 25.4), ("foot", 304.8), ("meter", 1000)],
)
def test_lengths_are_in_millimetres(unit: str, factor: float) -> None:
    model = square(unit=unit)
    model.item(1, [1.0, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 0])
    expected = np.add(SQUARE.vertices, [2, 0, 0]) * factor
    np.testing.assert_allclose(read(model.package()).vertices, expected, rtol=1e-15)


def test_a_mirrored_object_keeps_its_outside_outside() -> None:
    model = square()
    model.item(1, [-1.0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0])
    mesh = read(model.package())
    assert mesh.faces.tolist() == [[a, c, b] for a, b, c in SQUARE.polygons]


def test_objects_of_other_parts_are_followed() -> None:
    """As slicers write them with the production extension."""
    other = square()
    model = Model3MF(attributes='requiredextensions="p"')
    model.add('<components><component p:path="/3D/Objects/a.model" objectid="1"/></components>')
    model.item(1)
    data = model.package(**{"3D/Objects/a.model": other.xml()})
    assert read(data).faces.tolist() == SQUARE.polygons
    with pytest.raises(InvalidMesh, match=r"no part '/3D/Objects/a.model'"):
        read(model.package())


def test_the_model_is_the_one_that_the_package_names() -> None:
    model = square()
    model.item(1)
    for name in ("3D/3dmodel.model", "Other/Thing.model"):
        assert len(read(model.package(name)).faces) == 2
    assert len(read(package({"3D/3dmodel.model": model.xml()})).faces) == 2
    relationships = RELATIONSHIPS.format(target="/3D/none.model")
    with pytest.raises(InvalidMesh, match=r"no part '/3D/none\.model'"):
        read(package({"[Content_Types].xml": TYPES, "_rels/.rels": relationships, "3D/other.model": model.xml()}))
    with pytest.raises(UnsupportedFormat, match="no 3D model"):
        read(package({"word/document.xml": "<x/>", "x.models": ""}))


def test_namespaces_decide_and_not_their_prefixes() -> None:
    model = square()
    model.item(1)
    with_prefix = model.xml().replace("xmlns=", "xmlns:q=")
    for name in (
        "model",
        "resources",
        "object",
        "mesh",
        "vertices",
        "vertex",
        "triangles",
        "triangle",
        "build",
        "item",
    ):
        with_prefix = with_prefix.replace(f"<{name} ", f"<q:{name} ").replace(f"<{name}>", f"<q:{name}>")
        with_prefix = with_prefix.replace(f"</{name}>", f"</q:{name}>")
    assert read(package({"3D/3dmodel.model": with_prefix})).faces.tolist() == SQUARE.polygons
    foreign = model.xml().replace("core/2015/02", "core/2099/01")
    with pytest.raises(InvalidMesh, match="no element 'model'"):
        read(package({"3D/3dmodel.model": foreign}))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('v1="0"', 'v1="4"'), r"Triangle 0 of object '1' .* outside 0\.\.3"),
        (('v1="0"', 'v1="-1"'), "Triangle 0"),
        (('v1="0"', 'v1="0.5"'), "Line 1: an attribute"),
        (('v1="0"', 'v1="1_0"'), "Line 1: an attribute"),
        (('v1="0"', 'v1="99999999999"'), "Line 1: an attribute"),
        (('v1="0"', ""), "Line 1: an attribute"),
        (('x="0.0"', 'x="nan"'), "Vertex 0 has a coordinate that is not finite"),
        (('x="0.0"', 'x="1e999"'), "Vertex 0"),
        (('x="0.0"', 'x="one"'), "Line 1: an attribute"),
        (('objectid="1"', 'objectid="7"'), "object '7'"),
        (('objectid="1"', 'objectid="1" transform="1 0 0"'), "Line 1: an attribute"),
        (('objectid="1"', f'objectid="1" transform="{"nan " * 12}"'), "Line 1: an attribute"),
        (("</model>", ""), "Line 1: the XML"),
        (("<build>", "<build><"), "Line 1: the XML"),
        (("<build>", '</resources><resources><object id="1"/></resources><build>'), "the XML"),
        (("<resources>", '<resources><object id="1"/>'), "two objects '1'"),
        (('<item objectid="1" />', ""), "no item"),
    ],
)
def test_damage_is_refused_with_its_place(change: tuple[str, str], message: str) -> None:
    model = square()
    model.item(1)
    assert change[0] in model.xml()
    with pytest.raises(InvalidMesh, match=message):
        read(package({"3D/3dmodel.model": model.xml().replace(*change, 1)}))


def test_an_unknown_unit_is_refused() -> None:
    model = square(unit="parsec")
    model.item(1)
    with pytest.raises(InvalidMesh, match="'parsec'"):
        read(model.package())


def test_a_required_extension_that_changes_the_shape_is_refused_by_name() -> None:
    lattice = "http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"
    for form in ('xmlns:b="{}" requiredextensions="p b"', 'requiredextensions="p b" xmlns:b="{}"'):
        model = square(attributes=form.format(lattice))
        model.item(1)
        with pytest.raises(UnsupportedFormat, match="beamlattice"):
            read(model.package())
    model = square(attributes=f'xmlns:b="{lattice}"')
    model.item(1)
    assert len(read(model.package()).faces) == 2


def test_objects_within_objects_are_counted_before_they_are_built() -> None:
    """2 ** 40 squares in two kilobytes."""
    model = square()
    for level in range(40):
        model.assembly([(level + 1, None), (level + 1, None)])
    model.item(41)
    with pytest.raises(LimitExceeded, match=f"{2**41} faces, more than max_faces"):
        read(model.package())


def test_empty_objects_count_as_placed() -> None:
    model = Model3MF()
    model.add("")
    for level in range(40):
        model.assembly([(level + 1, None), (level + 1, None)])
    model.item(41)
    with pytest.raises(LimitExceeded, match="places objects more than"):
        read(model.package())


def test_an_object_inside_itself_is_refused() -> None:
    for cycle in ([(2, None)], [(3, None)]):
        model = square()
        model.assembly([(1, None), *cycle])
        model.assembly([(2, None)])
        model.item(3)
        with pytest.raises(InvalidMesh, match="inside itself"):
            read(model.package())


def test_a_long_chain_of_objects_is_read() -> None:
    model = square()
    for level in range(5000):
        model.assembly([(level + 1, [*IDENTITY[:9], 1.0, 0, 0])])
    model.item(5001)
    assert read(model.package()).vertices[0].tolist() == [5000, 0, 0]


def test_entities_are_refused_before_they_are_expanded() -> None:
    model = square()
    model.item(1)
    laughs = '<!ENTITY a "ha">' + "".join(f'<!ENTITY {b} "{f"&{a};" * 10}">' for a, b in zip("abcdef", "bcdefg"))  # noqa: B905
    for declaration in (f"<!DOCTYPE model [{laughs}]>", '<!DOCTYPE model [<!ENTITY g SYSTEM "file:///etc/passwd">]>'):
        xml = model.xml().replace("?><model", f"?>{declaration}<model").replace("Title", "&g;")
        with pytest.raises(InvalidMesh, match="document type"):
            read(package({"3D/3dmodel.model": xml}))


def test_what_an_archive_unpacks_to_is_checked_before_it_is_unpacked() -> None:
    model = square()
    model.item(1)
    spaces = model.xml().replace("<build>", " " * 10**6 + "<build>")
    data = package({"3D/3dmodel.model": spaces})
    assert len(data) < 10**4
    assert len(read(data).faces) == 2
    with pytest.raises(LimitExceeded, match="max_uncompressed_bytes = 100000"):
        read(data, limits=ReadLimits(max_uncompressed_bytes=10**5))


def test_a_size_that_is_a_lie_unpacks_no_further() -> None:
    model = square()
    model.item(1)
    data = package({"3D/3dmodel.model": model.xml().replace("<build>", " " * 10**6 + "<build>")})
    entry = data.rindex(b"PK\x01\x02")
    lie = data[: entry + 24] + struct.pack("<I", 1000) + data[entry + 28 :]
    with pytest.raises(InvalidMesh, match="damaged"):
        read(lie, limits=ReadLimits(max_uncompressed_bytes=10**5))


def test_limits_of_faces_and_vertices_hold_while_the_model_is_parsed() -> None:
    model = square()
    model.item(1)
    for limits, name in ((ReadLimits(max_faces=1), "max_faces = 1"), (ReadLimits(max_vertices=3), "max_vertices = 3")):
        with pytest.raises(LimitExceeded, match=name):
            read(model.package(), limits=limits)


def test_encrypted_or_oddly_compressed_parts_are_refused() -> None:
    model = square()
    model.item(1)
    squeezed = package({"3D/3dmodel.model": model.xml()}, zipfile.ZIP_BZIP2)
    with pytest.raises(UnsupportedFormat, match="deflate"):
        read(squeezed)
    data = package({"3D/3dmodel.model": model.xml()})
    entry = data.rindex(b"PK\x01\x02")
    with pytest.raises(UnsupportedFormat, match="encrypted"):
        read(data[: entry + 8] + b"\1\0" + data[entry + 10 :])


def test_very_many_parts_are_refused_before_they_are_listed() -> None:
    with pytest.raises(InvalidMesh, match="more than 10000 parts"):
        read(THREEMF_SQUARE + b"PK\x01\x02" * 10_001)


@pytest.mark.parametrize("shift", [1, 65_536, 2**31])
def test_a_directory_that_points_before_the_archive_is_refused(shift: int) -> None:
    end = THREEMF_SQUARE.rindex(b"PK\x05\x06")
    (offset,) = struct.unpack_from("<I", THREEMF_SQUARE, end + 16)
    wrong = THREEMF_SQUARE[: end + 16] + struct.pack("<I", offset + shift) + THREEMF_SQUARE[end + 20 :]
    with pytest.raises(InvalidMesh, match="damaged or cut short"):
        read(wrong)


def test_a_package_that_is_cut_short_is_refused() -> None:
    for length in range(len(THREEMF_SQUARE)):
        assert read_or_none(THREEMF_SQUARE[:length], "3mf") is None


@given(st.data())
def test_damaged_packages_and_models_give_the_mesh_or_a_typed_error(data: st.DataObject) -> None:
    model = square()
    model.item(1)
    xml = bytearray(model.xml().encode())
    for _ in range(data.draw(st.integers(0, 3))):
        at = data.draw(st.integers(0, len(xml) - 1))
        xml[at : at + data.draw(st.integers(0, 3))] = data.draw(st.binary(max_size=2))
    whole = bytearray(package({"3D/3dmodel.model": bytes(xml)}))
    for _ in range(data.draw(st.integers(0, 2))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    read_or_none(bytes(whole), "3mf")


def test_a_damaged_stream_is_refused() -> None:
    data = bytearray(THREEMF_SQUARE)
    begin = data.index(zlib.compress(b"")[:0] or b"3D/3dmodel.model") + 40
    data[begin] ^= 0x55
    with pytest.raises(InvalidMesh):
        read(bytes(data))


def test_every_placed_object_is_a_group() -> None:
    model = square()
    assembly = model.assembly([(1, None), (1, [*IDENTITY[:9], 2, 0, 0])])
    model.item(assembly)
    model.item(1, [*IDENTITY[:9], 4, 0, 0])
    structure = read(model.package()).structure
    assert structure.group.tolist() == [0, 0, 1, 1, 2, 2]
    assert structure.material is None


def painted(resource: str, triangles: list[str], default: str = "") -> list[int]:
    """The materials of an object of triangles with attributes, after an object without any."""
    model = square(attributes=f'xmlns:m="{MATERIAL}"')
    model.objects.append(resource)
    faces = "".join(f'<triangle v1="0" v2="1" v3="2" {attributes}/>' for attributes in triangles)
    corners = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in SQUARE.vertices)
    content = f"<mesh><vertices>{corners}</vertices><triangles>{faces}</triangles></mesh>"
    model.objects.append(f'<object id="5" {default}>{content}</object>')
    model.item(1)
    model.item(5)
    structure = read(model.package()).structure
    assert structure.material[:2].tolist() == [-1, -1]
    return structure.material[2:].tolist()


def test_a_triangle_has_its_own_material_or_that_of_its_object() -> None:
    base = '<basematerials id="9"><base name="a"/><base name="b"/></basematerials>'
    triangles = ["", 'p1="1"', 'pid="9" p1="0"', 'pid="9" p1="1"']
    assert painted(base, triangles, 'pid="9" pindex="0"') == [0, 1, 0, 1]
    assert painted(base, triangles[2:]) == [0, 1]


def test_a_uniform_colour_is_a_material_and_a_texture_is_one_as_a_whole() -> None:
    colors = '<m:colorgroup id="9"><m:color color="#F00"/><m:color color="#0F0"/></m:colorgroup>'
    corners = [
        'pid="9" p1="0"',
        'pid="9" p1="1" p2="1" p3="1"',
        'pid="9" p1="0" p2="1" p3="1"',
        'pid="9" p1="0" p2="0"',
    ]
    assert painted(colors, corners) == [0, 1, 2, 0]
    texture = '<m:texture2dgroup id="9" texid="8"><m:tex2coord u="0" v="0"/></m:texture2dgroup>'
    assert painted(texture, corners) == [0, 0, 0, 0]
