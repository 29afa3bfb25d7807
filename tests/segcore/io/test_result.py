"""The .cleave file: exact, the same bytes for the same result, never half read."""

import base64
import io
import json
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from helpers.files.appearances import at_corners, looks
from helpers.files.hierarchies import segmentations, two_strips
from helpers.files.written import written
from segcore.errors import CleaveError, InvalidMesh, InvalidParameters
from segcore.hierarchy import Hierarchy
from segcore.io.result import Segmentation, read_result, write_result
from segcore.mesh import Mesh

# The result of the two strips as Cleave wrote it before there were steps.
BEFORE_STEPS = zlib.decompress(
    base64.b85decode(
        b"c-pO1&5P4O6rc3VRCkv>RAFy1mnfu*+g(8xVap<3iV{H&p2Cn$-Do!H=A$4>kFGrytS7G?iXhap_#cSiU!Yz*d(_kVrk%-VvJF(5DX)_^^L~"
        b"^0<$W2gVyT8^<0?9FPe=RkMCB650l{tJZ$1q?_gL+C{vi(4T}8DVf_tRylOS?JRaev=@dMj)VQ&jG9EBcO+LjrRCx^rh1K4Qv4R}>Oe$}VO#"
        b"{MZAE2xIx2tbfv)9pT&&^qc$GfO_dy8q~&@mNAVbgZ>WVENjvqTTM?(sV_Gn}t4hP0xqh!unn81O(QD1KcH`U)#E&E8Ev~rLX+&xQG@SzxFa"
        b"Vn)8?CjP>>AV(0Sp^nR>ooFiwfpS@S~)|JUgpL?qc-s<3lt0v5h&+}bn?=0l1on<{Wb5#X|MGh)6y$DhTDY0jn=_1wFf6xz3bq%NnUB?bh*J"
        b"~5bcff21dGKxM%dusA3+H(J{PrPEuvOq;MWNZlP88D^GSeZ-A;WT_aW;PMiFE9j+wVCY8R%f2V9sRBtj2jTxtSZ2=KLJ}9?v4fuMa;SB?FJ<"
        b"m}z;D8*-i_W;@Cw@N(c;Vu4p+$tIl(!gqHrzeon*loNE1&c6lW!nI>*N)oFL5~~wNODfcg*&ULPx6@*i=$8~&FN*z+_A)9f0`M99C%a!7No("
        b"(fmDj3(+<*@sSK>5`*0BMrQfmUN1O&yZmd4WBF=Sp@6|kQHD^!v+l;-J}<)SP=-@y0eS(`@D*dMXT7BAZ`qf{oOu{6f!U-m%-i4kYC%9UyRg"
        b"Wnf$gmQsue*s;Ww$="
    )
)
ARRAYS = ("split_node", "cut_value", "area", "face_count", "face_leaf", "step")


def result(mesh: Mesh, hierarchy: Hierarchy) -> bytes:
    target = io.BytesIO()
    write_result(target, mesh, hierarchy)
    return target.getvalue()


def assert_same(segmentation: Segmentation, mesh: Mesh, hierarchy: Hierarchy) -> None:
    for name in ARRAYS:
        array, expected = getattr(segmentation.hierarchy, name), getattr(hierarchy, name)
        assert array.dtype == expected.dtype
        assert array.flags.writeable
        assert array.tolist() == expected.tolist()
    assert segmentation.hierarchy.automatic_segments == hierarchy.automatic_segments
    assert segmentation.hierarchy.limit_reached is hierarchy.limit_reached
    assert segmentation.mesh.vertices.tolist() == mesh.vertices.tolist()
    assert segmentation.mesh.faces.tolist() == mesh.faces.tolist()


@given(segmentations())
def test_what_is_written_is_what_is_read(segmented: tuple[Mesh, Hierarchy, int]) -> None:
    mesh, hierarchy, _ = segmented
    data = result(mesh, hierarchy)
    assert_same(read_result(io.BytesIO(data)), mesh, hierarchy)
    assert data == result(mesh, hierarchy)


def test_the_polygons_of_the_file_are_kept(tmp_path: Path) -> None:
    mesh, hierarchy = two_strips()
    polygons = Mesh(mesh.vertices, mesh.faces, [0, 0, 1, 1])
    path = tmp_path / "strips.cleave"
    with path.open("wb") as file:
        write_result(file, polygons, hierarchy)
    read = read_result(path).mesh
    assert read.source_polygon is not None
    assert read.source_polygon.tolist() == [0, 0, 1, 1]
    assert read_result(io.BytesIO(result(mesh, hierarchy))).mesh.source_polygon is None


def test_the_bytes_are_those_of_the_documented_form() -> None:
    """A ZIP reader and NumPy are enough to read it."""
    mesh, hierarchy = two_strips()
    with zipfile.ZipFile(io.BytesIO(result(mesh, hierarchy))) as archive:
        names = ["header.json", *(f"{name}.npy" for name in ("vertices", "faces", *ARRAYS))]
        assert archive.namelist() == names
        assert {member.date_time for member in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert {member.compress_type for member in archive.infolist()} == {zipfile.ZIP_STORED}
        header = json.loads(archive.read("header.json"))
        expected = {"format": "cleave-result", "version": 1, "automatic_segments": 2, "limit_reached": None}
        expected |= {"unit": None, "up": None, "usual_up": "y"}
        assert header == expected
        for name in ("vertices", "faces"):
            array = np.load(io.BytesIO(archive.read(f"{name}.npy")), allow_pickle=False)
            assert array.tolist() == getattr(mesh, name).tolist()


def test_a_file_from_before_steps_is_read_with_a_step_for_each_split() -> None:
    with zipfile.ZipFile(io.BytesIO(BEFORE_STEPS)) as archive:
        assert "step.npy" not in archive.namelist()
        assert "limit_reached" not in json.loads(archive.read("header.json"))
    read = read_result(io.BytesIO(BEFORE_STEPS))
    assert_same(read, *two_strips())
    assert read.hierarchy.step.tolist() == [0, 1]
    assert read.hierarchy.limit_reached is None


def test_a_cut_file_is_refused() -> None:
    data = result(*two_strips())
    for length in range(len(data)):
        with pytest.raises(InvalidMesh):
            read_result(io.BytesIO(data[:length]))


@given(st.data())
def test_a_damaged_file_is_read_exactly_or_refused(data: st.DataObject) -> None:
    mesh, hierarchy = two_strips()
    damaged = bytearray(result(mesh, hierarchy))
    for _ in range(data.draw(st.integers(1, 4))):
        damaged[data.draw(st.integers(0, len(damaged) - 1))] = data.draw(st.integers(0, 255))
    try:
        segmentation = read_result(io.BytesIO(damaged))
    except CleaveError:
        return
    assert_same(segmentation, mesh, hierarchy)


@given(st.binary(max_size=300))
def test_other_bytes_are_refused(data: bytes) -> None:
    with pytest.raises(InvalidMesh):
        read_result(io.BytesIO(data))


def test_a_missing_file_is_an_error_of_the_system(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        read_result(tmp_path / "missing.cleave")


def rebuilt(members: dict[str, bytes | None], compression: int = zipfile.ZIP_STORED) -> io.BytesIO:
    """The result of the two strips with some members replaced, or left out if None."""
    target = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(result(*two_strips()))) as old, zipfile.ZipFile(target, "w", compression) as new:
        for name in old.namelist():
            content = members.get(name, old.read(name))
            if content is not None:
                new.writestr(name, content)
    return target


def npy(array: np.ndarray) -> bytes:
    target = io.BytesIO()
    np.save(target, array, allow_pickle=True)
    return target.getvalue()


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("header.json", b'{"format": "cleave-result", "version": 2, "automatic_segments": 2}', "version 2.*version 1"),
        ("header.json", b'{"format": "other", "version": 1, "automatic_segments": 2}', "not a .cleave file"),
        ("header.json", b'{"format": "cleave-result", "version": 1, "automatic_segments": 2.0}', "automatic_segments"),
        ("header.json", b'{"format": "cleave-result", "version": 1, "automatic_segments": 4}', "contradicts itself"),
        (
            "header.json",
            b'{"format": "cleave-result", "version": 1, "automatic_segments": 2, "limit_reached": 1}',
            "limit_reached",
        ),
        ("header.json", b"[" * 5000, "header"),
        ("header.json", None, "no member 'header.json'"),
        ("faces.npy", None, "no member 'faces.npy'"),
        ("faces.npy", npy(np.zeros((4, 3), dtype=np.int64)), "'faces'"),
        ("faces.npy", npy(np.zeros((0, 3), dtype=np.int32)), "no faces"),
        ("faces.npy", npy(np.full((4, 3), 10, dtype=np.int32)), "outside 0..9"),
        ("faces.npy", npy(np.array([{}], dtype=object)), "'faces'"),
        ("faces.npy", npy(np.zeros((4, 3), dtype=np.int32))[:-1], "'faces'"),
        ("vertices.npy", npy(np.full((10, 3), np.nan)), "not finite"),
        ("face_leaf.npy", npy(np.array([1, 3, 1], dtype=np.int32)), "'face_leaf'"),
        ("face_leaf.npy", npy(np.array([1, 3, 1, 2], dtype=np.int32)), "contradicts itself"),
        ("face_leaf.npy", npy(np.array([1, 3, 1, 5], dtype=np.int32)), "contradicts itself"),
        ("face_leaf.npy", npy(np.array([1, 3, 1, 1], dtype=np.int32)), "contradicts itself"),
        ("split_node.npy", npy(np.array([0, 0], dtype=np.int32)), "contradicts itself"),
        ("split_node.npy", npy(np.array([0, 3], dtype=np.int32)), "contradicts itself"),
        ("split_node.npy", npy(np.array([0], dtype=np.int32)), "'cut_value'"),
        ("area.npy", npy(np.zeros((5, 1))), "'area'"),
        ("step.npy", npy(np.zeros(1, dtype=np.int32)), "'step'"),
        ("step.npy", npy(np.array([1, 0], dtype=np.int32)), "contradicts itself"),
        ("step.npy", npy(np.array([0, -1], dtype=np.int32)), "contradicts itself"),
    ],
)
def test_a_file_that_contradicts_itself_or_this_version_is_refused(
    name: str, content: bytes | None, message: str
) -> None:
    with pytest.raises(InvalidMesh, match=message):
        read_result(rebuilt({name: content}))


def test_compressed_members_are_refused_before_they_are_unpacked() -> None:
    with pytest.raises(InvalidMesh, match="compressed"):
        read_result(rebuilt({"faces.npy": b"\0" * 10**6}, zipfile.ZIP_DEFLATED))


def test_a_hierarchy_of_another_mesh_is_not_written() -> None:
    mesh, hierarchy = two_strips()
    with pytest.raises(InvalidParameters, match="4 faces and the mesh 1"):
        result(Mesh(mesh.vertices, mesh.faces[:1]), hierarchy)


@given(looks())
def test_a_result_file_keeps_everything(looking: tuple[Mesh, Hierarchy]) -> None:
    mesh, hierarchy = looking
    back = read_result(io.BytesIO(written("cleave", mesh, hierarchy))).mesh
    assert at_corners(back) == at_corners(mesh)
    assert back.appearance.extra_vertex.tolist() == mesh.appearance.extra_vertex.tolist()
    assert back.appearance.face_group.tolist() == mesh.appearance.face_group.tolist()
    assert back.appearance.group_names == mesh.appearance.group_names
