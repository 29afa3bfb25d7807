"""The 3MF reader."""

import numpy as np

from segcore.appearance import group_appearance
from segcore.arrays import FloatArray, IntArray, transformed
from segcore.errors import InvalidMesh, LimitExceeded
from segcore.io.limits import ReadLimits
from segcore.io.threemf.model import MaterialKey, Model, ModelObject, ObjectKey, Placed, parse_model
from segcore.io.threemf.package import Package
from segcore.io.threemf.slicer import leave_out_volumes
from segcore.mesh import Mesh
from segcore.structure import NO_ENTRY, file_structure, numbered_runs

_MOST_PLACES = 100_000  # placed objects, also those without a mesh, after components are expanded; set by hand


def read_3mf(data: bytes, limits: ReadLimits, with_appearance: bool = False) -> Mesh:
    """Read everything that a 3MF file builds, in millimetres.

    Face order: the items of the build, the components of each in their order, the triangles of each. An object that is
    placed several times is repeated. If a transform mirrors an object, the orientation of its faces is reversed, so
    that their outside stays outside. Volumes of slicer projects that are no part of the body (negative volumes,
    modifiers, support blockers, support enforcers) are left out and noted. Materials, textures and thumbnails are
    ignored; the appearance is the names of the objects.

    Raises
    ------
    InvalidMesh, UnsupportedFormat, LimitExceeded
    """
    objects = _Objects(Package(data, limits), limits)
    counts = _Counts(objects)
    for item in objects.root.items:
        counts.add(item.object)
    limits.check_faces(sum(counts.faces[item.object] for item in objects.root.items))
    limits.check_vertices(sum(counts.vertices[item.object] for item in objects.root.items))
    if sum(counts.places[item.object] for item in objects.root.items) > _MOST_PLACES:
        raise LimitExceeded(f"The 3MF file places objects more than {_MOST_PLACES} times: merge them into fewer.")
    placed = _meshes(objects, counts)
    if not placed:
        notes = "".join(f" {note}" for note in objects.notes)
        raise InvalidMesh(f"The 3MF file builds no mesh: its build has no item with triangles.{notes}")
    return _assemble(placed, objects, with_appearance)


class _Objects:
    """The objects of all model parts that are referenced; each part is parsed once."""

    def __init__(self, package: Package, limits: ReadLimits) -> None:
        self._package = package
        self._limits = limits
        self._materials: dict[MaterialKey, int] = {}
        self.root = self._parse(package.root_model(), "")
        self.notes = tuple(leave_out_volumes(self.root, package))
        self._models = {"": self.root}

    def __getitem__(self, key: ObjectKey) -> ModelObject:
        part, number = key
        if part not in self._models:
            self._models[part] = self._parse(part, part)
        if number not in self._models[part].objects:
            raise InvalidMesh(f"The 3MF file refers to an object {number[:40]!r}, which it does not have.")
        return self._models[part].objects[number]

    def _parse(self, name: str, part: str) -> Model:
        return parse_model(self._package.chunks(name), part, self._limits, self._materials)


class _Counts:
    """The number of faces, vertices and placed objects of each object with its components."""

    def __init__(self, objects: _Objects) -> None:
        self._objects = objects
        self.faces: dict[ObjectKey, int] = {}
        self.vertices: dict[ObjectKey, int] = {}
        self.places: dict[ObjectKey, int] = {}

    def add(self, root: ObjectKey) -> None:
        """Count an object and its components; raises InvalidMesh if it contains itself."""
        waiting, open_objects = [root], set()
        while waiting:
            key = waiting[-1]
            components = [component.object for component in self._objects[key].components]
            missing = [component for component in components if component not in self.faces]
            if key in self.faces:
                waiting.pop()
            elif not missing:
                self._sum_up(key, components)
                open_objects.discard(key)
                waiting.pop()
            elif key in open_objects:
                raise InvalidMesh(f"Object {key[1][:40]!r} of the 3MF file is inside itself.")
            else:
                open_objects.add(key)
                waiting.extend(missing)

    def _sum_up(self, key: ObjectKey, components: list[ObjectKey]) -> None:
        own = self._objects[key]
        self.faces[key] = len(own.triangles) // 3 + sum(self.faces[component] for component in components)
        self.vertices[key] = len(own.vertices) // 3 + sum(self.vertices[component] for component in components)
        self.places[key] = 1 + sum(self.places[component] for component in components)


def _meshes(objects: _Objects, counts: _Counts) -> list[Placed]:
    """All objects with triangles in the order of the build, with their transforms."""
    found = []
    waiting = list(reversed(objects.root.items))
    while waiting:
        place = waiting.pop()
        if len(objects[place.object].triangles):
            found.append(place)
        waiting.extend(
            Placed(component.object, place.transform @ component.transform)
            for component in reversed(objects[place.object].components)
            if counts.faces[component.object]
        )
    return found


def _assemble(placed: list[Placed], objects: _Objects, with_appearance: bool) -> Mesh:
    sources = [objects[place.object] for place in placed]
    vertex_end = np.cumsum([len(source.vertices) // 3 for source in sources]).tolist()
    face_end = np.cumsum([len(source.triangles) // 3 for source in sources]).tolist()
    vertices, faces = np.empty((vertex_end[-1], 3)), np.empty((face_end[-1], 3), dtype=np.int32)
    for i, (place, source) in enumerate(zip(placed, sources, strict=True)):
        own_vertices = slice(vertex_end[i] - len(source.vertices) // 3, vertex_end[i])
        own_faces = slice(face_end[i] - len(source.triangles) // 3, face_end[i])
        _place(source, place.transform, vertices[own_vertices])
        np.add(_faces(source, place), own_vertices.start, out=faces[own_faces])
    vertices *= objects.root.unit
    sizes = np.diff(face_end, prepend=0).tolist()
    appearance = group_appearance([source.name for source in sources], sizes) if with_appearance else None
    return Mesh(
        vertices,
        faces,
        appearance=appearance,
        structure=file_structure(numbered_runs(range(len(sizes)), sizes), _materials(sources)),
        notes=objects.notes,
    )


def _materials(sources: list[ModelObject]) -> IntArray | None:
    """(F,) the numbers of the materials of all faces; None if none has one."""
    materials = np.concatenate([np.frombuffer(source.materials, dtype=np.int32) for source in sources])
    return materials if (materials != NO_ENTRY).any() else None


def _place(source: ModelObject, transform: FloatArray, vertices: FloatArray) -> None:
    """Fill ``vertices`` (V, 3) with the transformed vertices of an object."""
    own = np.frombuffer(source.vertices, dtype=np.float64).reshape(-1, 3)
    np.add(transformed(own, transform[:3, :3]), transform[:3, 3], out=vertices)


def _faces(source: ModelObject, place: Placed) -> IntArray:
    faces = np.frombuffer(source.triangles, dtype=np.int32).reshape(-1, 3)
    count = len(source.vertices) // 3
    outside = ((faces < 0) | (faces >= count)).any(axis=1)
    if outside.any():
        first = int(np.argmax(outside))
        raise InvalidMesh(
            f"Triangle {first} of object {place.object[1][:40]!r} of the 3MF file refers to a vertex outside "
            f"0..{count - 1}."
        )
    return faces[:, [0, 2, 1]] if np.linalg.det(place.transform[:3, :3]) < 0 else faces
