"""Readers in plain Python, word by word: the oracles of the fast readers.

Each returns the vertices and the triangles of a file, or raises any exception if the file is not complete and valid.
"""

import base64
import io
import json
import math
import re
import struct
import zipfile
from collections.abc import Callable
from xml.etree import ElementTree

from helpers.files.polygon_soups import Point, Triangle, triangulated

Result = tuple[list[Point], list[Triangle]]
_NUMBER = re.compile(rb"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")


def number(word: bytes) -> float:
    assert _NUMBER.fullmatch(word), word
    return float(word)


def whole(word: bytes) -> int:
    value = number(word)
    assert value == int(value)
    return int(value)


def checked(vertices: list[Point], polygons: list[list[int]]) -> Result:
    assert all(0 <= corner < len(vertices) for polygon in polygons if len(polygon) > 2 for corner in polygon)
    faces = triangulated(vertices, polygons)
    assert faces
    used = {corner for face in faces for corner in face}
    assert all(_is_usable(vertices[corner]) for corner in used)
    return [point if _is_usable(point) else vertices[faces[0][0]] for point in vertices], faces


def _is_usable(point: Point) -> bool:
    return all(abs(value) <= 1e100 for value in point)


def lines_of(data: bytes) -> list[bytes]:
    data = data.rstrip(b"\0\x1a").removeprefix(b"\xef\xbb\xbf")
    assert not re.search(rb"[\x00-\x08\x0e-\x1f]", data)
    return re.split(rb"\r*\n|\r", data)


def slow_off(data: bytes) -> Result:
    text = b"\n".join(line.partition(b"#")[0] for line in lines_of(data))
    keyword = re.match(rb"\s*((?:ST|C|N)*)OFF(?!\s+BINARY)", text)
    keyword = keyword or re.match(rb"\s*()(?=\d+[ \t]+\d+[ \t]*(\d+[ \t]*)?\n)", text)
    assert keyword
    prefixes = keyword[1]
    rest = text[keyword.end() :].split(b"\n")
    words = [(row, word) for row, line in enumerate(rest) for word in line.split()]
    lines = [row for row, _ in words]
    has_edges = lines[1] == lines[2] or lines.count(lines[2]) == 1
    at = 3 if has_edges else 2
    vertex_count, face_count = [whole(word) for _, word in words[:at]][:2]
    assert vertex_count >= 0
    assert face_count >= 0
    width = 3 + 2 * (b"ST" in prefixes) + 4 * (b"C" in prefixes) + 3 * (b"N" in prefixes)
    first = [at + width * i for i in range(vertex_count)]
    try:
        assert at + width * vertex_count <= len(words)
        return _off_faces(words, first, at + width * vertex_count, face_count)
    except (AssertionError, IndexError, ValueError):
        return _off_with_vertex_lines(words, at, vertex_count, face_count)


def _off_with_vertex_lines(words: list[tuple[int, bytes]], at: int, vertex_count: int, face_count: int) -> Result:
    assert words[at][0] != words[at - 1][0]
    first = []
    for _ in range(vertex_count):
        first.append(at)
        row = words[at][0]
        while at < len(words) and words[at][0] == row:
            at += 1
        assert at - first[-1] >= 3
    return _off_faces(words, first, at, face_count)


def _off_faces(words: list[tuple[int, bytes]], first: list[int], at: int, face_count: int) -> Result:
    end = at
    faces: list[list[int]] = []
    for _ in range(face_count):
        size = whole(words[at][1])
        assert size >= 0
        last = words[at + size]
        faces.append([whole(word) for _, word in words[at + 1 : at + 1 + size]])
        at += size + 1
        while at < len(words) and words[at][0] == last[0]:
            at += 1
    assert at == len(words)
    for _, word in words[end:]:
        number(word)
    values = [number(word) for _, word in words[:end]]
    return checked([(values[i], values[i + 1], values[i + 2]) for i in first], faces)


def slow_obj(data: bytes) -> Result:
    text = b"\n".join(line.partition(b"#")[0] for line in lines_of(data))
    statements: list[list[bytes]] = []
    goes_on = False
    for line in text.split(b"\n"):
        words = line.rstrip(b" \t").removesuffix(b"\\").split()
        if goes_on:
            statements[-1] += words
        else:
            statements.append(words)
        is_broken = line.rstrip(b" \t").endswith(b"\\")
        goes_on = is_broken and statements[-1][:1] in ([b"v"], [b"f"], [b"vt"], [b"vn"], [b"vp"], [b"l"], [b"p"])
    total = sum(words[:1] == [b"v"] for words in statements)
    vertices: list[Point] = []
    faces: list[list[int]] = []
    for words in statements:
        if words[:1] == [b"v"]:
            values = [number(word) for word in words[1:]]
            vertices.append((values[0], values[1], values[2]))
        if words[:1] == [b"f"]:
            assert all(re.fullmatch(rb"[-+]?\d+(/[-/\d]*)?", word) for word in words[1:])
            indices = [int(word.partition(b"/")[0]) for word in words[1:]]
            corners = [i - 1 if i > 0 else len(vertices) + i for i in indices]
            assert 0 not in indices
            assert all(0 <= corner < total for corner in corners)
            faces.append(corners)
    return checked(vertices, faces)


_PLY = {
    b"char": "b", b"int8": "b", b"uchar": "B", b"uint8": "B", b"short": "h", b"int16": "h", b"ushort": "H",
    b"uint16": "H", b"int": "i", b"int32": "i", b"uint": "I", b"uint32": "I", b"float": "f", b"float32": "f",
    b"double": "d", b"float64": "d",
}  # fmt: skip


def slow_ply(data: bytes) -> Result:
    first = re.match(rb"(?i)ply[ \t]*(\r+\n|\n\r|\n|\r)", data)
    end = re.search(rb"[\r\n](end_header[ \t\v\f]*)[\r\n]", data)
    assert first
    assert end
    newline = rb"\r\n|\n|\r" if first[1] == b"\r" else rb"\r+\n|\n\r|\n"
    header, rest = data[: end.start(1)], data[end.end(1) :]
    endings = [re.findall(newline, header)[-1], first[1], b"\r\n", b"\n", b"\r"]
    body = rest.removeprefix(next(ending for ending in endings if rest.startswith(ending)))
    elements: list[tuple[bytes, int, list[list[bytes]]]] = []
    encoding = b""
    for line in re.split(newline, header)[1:]:
        words = line.split()
        if words[:1] == [b"format"]:
            encoding = words[1]
        elif words[:1] == [b"element"]:
            assert len(words) == 3
            assert words[1] not in [name for name, _, _ in elements]
            assert re.fullmatch(rb"\d+", words[2])
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == [b"property"]:
            assert len(words) == (5 if words[1] == b"list" else 3)
            elements[-1][2].append(words[1:])
        else:
            assert not words or not elements or words[0] in (b"comment", b"obj_info")
    if encoding == b"ascii":
        lines = _lines_of_rows(data, len(header))
        if len(lines) == sum(count for _, count, properties in elements if properties):
            rows = _rows_of_lines(lines, elements)
        else:
            take = _take_words(body)
            rows = {name: [_ply_row(properties, take) for _ in range(count)] for name, count, properties in elements}
            with_nothing_left(take)
    else:
        take = _take_bytes(body, encoding)
        rows = {name: [_ply_row(properties, take) for _ in range(count)] for name, count, properties in elements}
    vertices = [(float(row[b"x"]), float(row[b"y"]), float(row[b"z"])) for row in rows[b"vertex"]]
    faces: list[list[int]] = []
    for name, listed in rows.items():
        for row in listed:
            if name in (b"face", b"tristrips"):
                indices = row[b"vertex_indices"] if b"vertex_indices" in row else row[b"vertex_index"]
                assert all(index == int(index) for index in indices)
                corners = [int(index) for index in indices]
                faces += [corners] if name == b"face" else _strips(corners)
    return checked(vertices, faces)


def _lines_of_rows(data: bytes, begin: int) -> list[bytes]:
    return [line for line in lines_of(b" " * begin + data[begin:].replace(b"end_header", b" ", 1)) if line.split()]


def _rows_of_lines(lines: list[bytes], elements: list[tuple[bytes, int, list[list[bytes]]]]) -> dict:
    """The rows if there is exactly one line for each of them; what a line has too much is ignored."""
    wanted = [(name, properties) for name, count, properties in elements if properties for _ in range(count)]
    rows: dict[bytes, list] = {name: [] for name, _, _ in elements}
    for line, (name, properties) in zip(lines, wanted, strict=True):
        rows[name].append(_ply_row(properties, _take_words(line)))
    return rows


def _strips(corners: list[int]) -> list[list[int]]:
    faces: list[list[int]] = []
    strip: list[int] = []
    for corner in corners:
        strip = [] if corner == -1 else [*strip, corner]
        if len(strip) > 2:
            a, b, c = strip[-3:]
            faces.append([a, b, c] if len(strip) % 2 else [a, c, b])
    return faces


def _ply_row(properties: list[list[bytes]], take: Callable[[str], float]) -> dict[bytes, object]:
    row: dict[bytes, object] = {}
    for words in properties:
        if words[0] == b"list":
            size = take(_PLY[words[1]])
            assert size == int(size)
            assert size >= 0
            assert _PLY[words[1]] not in "fd"
            row[words[3]] = [take(_PLY[words[2]]) for _ in range(int(size))]
        else:
            row[words[1]] = take(_PLY[words[0]])
    return row


def _take_words(body: bytes) -> Callable[[str], float]:
    words = iter(body.rstrip(b"\0\x1a").split())

    def take(_: str) -> float:
        word = next(words, None)
        assert word is not None
        return number(word)

    return take


def with_nothing_left(take: Callable[[str], float]) -> None:
    try:
        take("d")
    except AssertionError:
        return
    raise ValueError("words after the last element")


def _take_bytes(body: bytes, encoding: bytes) -> Callable[[str], float]:
    order = {b"binary_little_endian": "<", b"binary_big_endian": ">"}[encoding]
    at = 0

    def take(kind: str) -> float:
        nonlocal at
        (value,) = struct.unpack_from(order + kind, body, at)
        at += struct.calcsize(order + kind)
        return float(value)

    return take


def slow_binary_stl(data: bytes) -> Result:
    (count,) = struct.unpack_from("<I", data, 80)
    there, rest = divmod(len(data) - 84, 50)
    if rest == 0 and (count < there or count == 2**32 - 1):
        count = there
    values = [struct.unpack_from("<12fH", data, 84 + 50 * i)[3:12] for i in range(count)]
    assert all(math.isfinite(value) for row in values for value in row)
    vertices = [(row[k], row[k + 1], row[k + 2]) for row in values for k in (0, 3, 6)]
    return checked(vertices, [(3 * i, 3 * i + 1, 3 * i + 2) for i in range(count)])


def slow_ascii_stl(data: bytes) -> Result:
    words: list[bytes] = []
    is_open = True
    for line in (line for line in lines_of(data.lower()) if line.strip()):
        first = line.split()[0]
        if first == b"solid" or re.match(rb"\s*end[ \t_-]*solid", line):
            is_open = first == b"solid"
        elif words[-1:] in ([], [b"endfacet"]) and first != b"facet" and re.match(rb"[^-+.\d]", first):
            assert not re.search(rb"outer\s+loop|endloop|endfacet", line)
        else:
            words += line.split()
            is_open = True
    assert not is_open
    vertices: list[Point] = []
    faces: list[list[int]] = []
    at = 0
    while at < len(words):
        assert words[at] == b"facet"
        at += 1
        if words[at] == b"normal":
            at += 4
        assert words[at : at + 2] == [b"outer", b"loop"]
        at += 2
        begin = len(vertices)
        while words[at] == b"vertex":
            x, y, z = (number(word) for word in words[at + 1 : at + 4])
            assert _is_usable((x, y, z))
            vertices.append((x, y, z))
            at += 4
        assert words[at : at + 2] == [b"endloop", b"endfacet"]
        assert len(vertices) >= begin + 3
        at += 2
        faces.append(list(range(begin, len(vertices))))
    return checked(vertices, faces)


_GLTF = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}


def slow_gltf(data: bytes) -> list[tuple[Point, Point, Point]]:
    """The corners of each triangle of the scene; glTF does not specify which vertices are shared."""
    chunks = []
    if data.startswith(b"glTF"):
        _, version, length = struct.unpack_from("<4sII", data)
        assert version == 2
        assert length <= len(data)
        at = 12
        while at < length:
            size, _ = struct.unpack_from("<I4s", data, at)
            assert at + 8 + size <= length
            chunks.append(data[at + 8 : at + 8 + size])
            at += 8 + size
    document = json.loads(chunks[0] if chunks else data)
    buffers = [
        base64.b64decode(buffer["uri"].partition(",")[2]) if "uri" in buffer else chunks[1]
        for buffer in document["buffers"]
    ]
    corners: list[tuple[Point, Point, Point]] = []
    if document.get("scenes"):
        roots = document["scenes"][document.get("scene", 0)].get("nodes", [])
    else:
        children = {child for node in document.get("nodes", []) for child in node.get("children", [])}
        roots = [node for node in range(len(document.get("nodes", []))) if node not in children]
    for root in roots:
        _visit(document, buffers, root, [[float(i == k) for k in range(4)] for i in range(4)], corners)
    return corners


def _visit(document: dict, buffers: list[bytes], index: int, parent: list[list[float]], corners: list) -> None:
    node = document["nodes"][index]
    matrix = _times(parent, _matrix(node))
    primitives = document["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []
    for primitive in primitives:
        if primitive.get("mode", 4) < 4:
            continue
        points = [_moved(matrix, point) for point in _accessor(document, buffers, primitive["attributes"]["POSITION"])]
        indices = list(range(len(points)))
        if "indices" in primitive:
            indices = [i for (i,) in _accessor(document, buffers, primitive["indices"])]
        for a, b, c in _triangles(indices, primitive.get("mode", 4)):
            corners.append((points[a], points[c], points[b]) if _mirrors(matrix) else (points[a], points[b], points[c]))
    for child in node.get("children", []):
        _visit(document, buffers, child, matrix, corners)


def _triangles(indices: list[int], mode: int) -> list[Triangle]:
    if mode == 4:
        return [(indices[i], indices[i + 1], indices[i + 2]) for i in range(0, len(indices), 3)]
    if mode == 5:
        return _strips(indices)
    return [(indices[i + 1], indices[i + 2], indices[0]) for i in range(len(indices) - 2)]


def _matrix(node: dict) -> list[list[float]]:
    if "matrix" in node:
        return [[node["matrix"][4 * column + row] for column in range(4)] for row in range(4)]
    x, y, z, w = node.get("rotation", [0, 0, 0, 1])
    turn = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
    ]
    scale, offset = node.get("scale", [1, 1, 1]), node.get("translation", [0, 0, 0])
    rows = [[turn[i][k] * scale[k] for k in range(3)] + [offset[i]] for i in range(3)]
    return [*rows, [0, 0, 0, 1]]


def _times(a: list[list[float]], b: list[list[float]]) -> list[list[float]]:
    return [[sum(a[i][j] * b[j][k] for j in range(4)) for k in range(4)] for i in range(4)]


def _moved(matrix: list[list[float]], point: Point) -> Point:
    x, y, z = (sum(matrix[i][k] * point[k] for k in range(3)) + matrix[i][3] for i in range(3))
    return x, y, z


def _mirrors(m: list[list[float]]) -> bool:
    determinant = (
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    )
    return determinant < 0


def _accessor(document: dict, buffers: list[bytes], index: int) -> list[tuple]:
    accessor = document["accessors"][index]
    width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
    form = "<" + width * _GLTF[accessor["componentType"]]
    rows = [(0,) * width] * accessor["count"]
    if "bufferView" in accessor:
        rows = _view(document, buffers, accessor, form, accessor["count"])
    if "sparse" in accessor:
        sparse = accessor["sparse"]
        places = _view(
            document, buffers, sparse["indices"], "<" + _GLTF[sparse["indices"]["componentType"]], sparse["count"]
        )
        values = _view(document, buffers, sparse["values"], form, sparse["count"])
        for (place,), value in zip(places, values, strict=True):
            rows[place] = value
    if accessor.get("normalized"):
        largest = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}[accessor["componentType"]]
        return [tuple(max(value / largest, -1.0) for value in row) for row in rows]
    return rows


def _view(document: dict, buffers: list[bytes], item: dict, form: str, count: int) -> list[tuple]:
    view = document["bufferViews"][item["bufferView"]]
    stride = view.get("byteStride", struct.calcsize(form))
    data = buffers[view["buffer"]][view.get("byteOffset", 0) :][: view["byteLength"]]
    return [struct.unpack_from(form, data, item.get("byteOffset", 0) + stride * i) for i in range(count)]


_CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
_UNITS = {"micron": 0.001, "millimeter": 1, "centimeter": 10, "inch": 25.4, "foot": 304.8, "meter": 1000}


def slow_3mf(data: bytes) -> list[tuple[Point, Point, Point]]:
    """The corners of each triangle of the build."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        model = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
    objects = {entry.get("id"): entry for entry in model.iter(f"{_CORE}object")}
    unit = _UNITS[model.get("unit", "millimeter")]
    corners: list[tuple[Point, Point, Point]] = []
    for item in model.iter(f"{_CORE}item"):
        _build(objects, item, [], corners)
    return [tuple((x * unit, y * unit, z * unit) for x, y, z in triangle) for triangle in corners]


def _build(objects: dict, place: ElementTree.Element, outer: list[list[float]], corners: list) -> None:
    transforms = [[float(word) for word in place.get("transform", "1 0 0 0 1 0 0 0 1 0 0 0").split()], *outer]
    entry = objects[place.get("objectid")]
    points = [_through(transforms, [float(v.get(axis)) for axis in "xyz"]) for v in entry.iter(f"{_CORE}vertex")]
    mirrored = sum(_turns_over(m) for m in transforms) % 2
    for triangle in entry.iter(f"{_CORE}triangle"):
        a, b, c = (points[int(triangle.get(key))] for key in ("v1", "v2", "v3"))
        corners.append((a, c, b) if mirrored else (a, b, c))
    for component in entry.iter(f"{_CORE}component"):
        _build(objects, component, transforms, corners)


def _through(transforms: list[list[float]], point: list[float]) -> Point:
    for m in transforms:
        x, y, z = point
        point = [x * m[i] + y * m[i + 3] + z * m[i + 6] + m[i + 9] for i in range(3)]
    return tuple(point)


def _turns_over(m: list[float]) -> bool:
    a, b, c, d, e, f, g, h, i = m[:9]
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0
