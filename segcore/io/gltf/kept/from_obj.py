"""A glTF document of an OBJ file with the materials and pictures of its set."""

import posixpath
from dataclasses import dataclass, field, replace

import numpy as np

from segcore.arrays import IntArray
from segcore.coordinates import Coordinates
from segcore.io.file_sets import Companions
from segcore.io.gltf.document import Item
from segcore.io.gltf.kept.builder import Materials
from segcore.io.gltf.kept.entries import add_once
from segcore.io.gltf.kept.from_mesh import corner_tables, document_of_mesh
from segcore.io.gltf.kept.pictures import picture_type
from segcore.io.gltf.kept.writer import KeptDocument
from segcore.io.limits import ReadLimits
from segcore.io.obj.corner_rows import CornerTable
from segcore.io.obj.materials import ObjMaterial, TextureMap, read_obj_materials, read_picture
from segcore.io.obj.reader import read_obj_model
from segcore.io.palette import linear_rgb
from segcore.structure import FileStructure

_TRANSFORM = "KHR_texture_transform"
_PICTURES = ("image/png", "image/jpeg")  # those that every viewer of glTF shows
_CLAMP, _REPEAT = 33071, 10497
_FULL_GLOSS = 1000.0  # the largest Ns
_KEPT_MAPS = ("map_kd", "map_ke", "norm")


def document_of_obj(data: bytes, limits: ReadLimits, companions: Companions, coordinates: Coordinates) -> KeptDocument:
    """Return the document of an OBJ file: groups and objects as nodes, materials with the pictures of its set.

    The colour factor is Kd with the opacity d, the emissive one Ke, the metallic one Pm, and the roughness Pr, else
    1 - sqrt(Ns / 1000). The pictures of map_Kd, map_Ke and norm are kept if they are PNG or JPEG; the others have no
    place in the material of glTF, or, as map_Bump, no certain meaning.

    Raises
    ------
    InvalidMesh, LimitExceeded
    """
    model = read_obj_model(data, limits)
    mesh = replace(model.mesh, coordinates=coordinates)
    tables = {name: table for name, table in corner_tables(mesh).items() if name == "colors"}
    if "colors" in tables:  # of vertices
        tables["colors"] = CornerTable(tables["colors"].values, model.mesh.faces)
    for name, table in model.corners.items():
        values = table.values * [1, -1] + [0, 1] if name == "uvs" else table.values
        tables[name] = CornerTable(values, table.rows)
    found = read_obj_materials(data, companions)
    return document_of_mesh(mesh, tables, _Converter(companions).materials(mesh.structure, found))


@dataclass(slots=True, eq=False)
class _Converter:
    companions: Companions
    textures: list[Item] = field(default_factory=list)
    samplers: list[Item] = field(default_factory=list)
    pictures: list[tuple[str, str, bytes]] = field(default_factory=list)
    extensions: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    _of_path: dict[tuple[str, str], int | None] = field(default_factory=dict)

    def materials(self, structure: FileStructure | None, found: dict[str, ObjMaterial]) -> Materials:
        names = structure.material_names if structure is not None else ()
        known = [name for name in names if name in found]
        entry_of = {name: i for i, name in enumerate(known)}
        of_face: IntArray | None = None
        if structure is not None and structure.material is not None and known:
            entries = np.array([*(entry_of.get(name, -1) for name in names), -1], dtype=np.int32)
            of_face = entries[structure.material]
        missing = [name for name in names if name not in found]
        if missing:
            self.notes.append(f"No material file of the set has {', '.join(map(repr, missing[:5]))}.")
        converted = [self._material(found[name]) for name in known]
        return Materials(
            of_face, converted, self.textures, self.samplers, self.pictures, self.extensions, tuple(self.notes)
        )

    def _material(self, material: ObjMaterial) -> Item:
        color = material.maps.get("map_kd")
        diffuse = material.diffuse or (1.0, 1.0, 1.0)
        if color is not None and not any(diffuse):
            diffuse = (1.0, 1.0, 1.0)  # else the picture would be black
        pbr: Item = {
            "baseColorFactor": [*_linear(diffuse), material.opacity],
            "metallicFactor": _unit(material.metallic or 0.0),
            "roughnessFactor": _roughness(material),
        }
        entry: Item = {"name": material.name, "doubleSided": True, "pbrMetallicRoughness": pbr}
        if (texture := self._texture(material, "map_kd")) is not None:
            pbr["baseColorTexture"] = texture
        if (texture := self._texture(material, "norm")) is not None:
            entry["normalTexture"] = texture
        if (texture := self._texture(material, "map_ke")) is not None:
            entry["emissiveTexture"] = texture
        if texture is not None or any(material.emissive or ()):
            emissive = material.emissive if any(material.emissive or ()) else None
            entry["emissiveFactor"] = _linear(emissive or (1.0, 1.0, 1.0))
        if material.opacity < 1 or ("map_d" in material.maps and material.maps["map_d"] == color):
            entry["alphaMode"] = "BLEND"
        left_out = [key for key in material.maps if key not in _KEPT_MAPS and material.maps[key] != color]
        if left_out:
            self.notes.append(f"Material {material.name!r}: {', '.join(left_out)} cannot be kept in glTF.")
        return entry

    def _texture(self, material: ObjMaterial, keyword: str) -> Item | None:
        texture = material.maps.get(keyword)
        picture = None if texture is None else self._picture(material, texture)
        if texture is None or picture is None:
            return None
        mode = _CLAMP if texture.is_clamped else _REPEAT
        sampler = add_once(self.samplers, {"wrapS": mode, "wrapT": mode})
        info: Item = {"index": add_once(self.textures, {"source": picture, "sampler": sampler})}
        (x, y), (width, height) = texture.offset, texture.scale
        if (x, y, width, height) != (0, 0, 1, 1):
            own = {"offset": [x, 1 - height - y], "scale": [width, height]}  # v counts from the top in glTF
            info["extensions"] = {_TRANSFORM: own}
            if _TRANSFORM not in self.extensions:
                self.extensions.append(_TRANSFORM)
        return info

    def _picture(self, material: ObjMaterial, texture: TextureMap) -> int | None:
        key = posixpath.dirname(material.library), texture.path
        if key not in self._of_path:
            self._of_path[key] = self._read(material, texture)
        return self._of_path[key]

    def _read(self, material: ObjMaterial, texture: TextureMap) -> int | None:
        data = read_picture(self.companions, material, texture)
        media_type = picture_type(data) if data is not None else None
        if data is None or media_type not in _PICTURES:
            reason = "is not in the set or cannot be read" if data is None else "is neither PNG nor JPEG"
            self.notes.append(f"The picture {texture.path[:80]!r} {reason}: it is left out.")
            return None
        name = posixpath.splitext(posixpath.basename(texture.path.replace("\\", "/")))[0]
        return add_once(self.pictures, (name, media_type, data))


def _roughness(material: ObjMaterial) -> float:
    if material.roughness is not None:
        return _unit(material.roughness)
    if material.shininess is None:
        return 1.0
    return 1.0 - _unit(material.shininess / _FULL_GLOSS) ** 0.5


def _linear(color: tuple[float, ...]) -> list[float]:
    """Linear light of a colour of an MTL file, which is sRGB as most programs write and show it."""
    return [round(value, 6) for value in linear_rgb(np.clip(np.array(color), 0.0, 1.0)).tolist()]


def _unit(value: float) -> float:
    return min(max(value, 0.0), 1.0)
