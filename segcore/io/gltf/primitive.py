"""What a mesh of a glTF asset is made of."""

from dataclasses import dataclass

from segcore.io.gltf.document import Item

TRIANGLES, STRIP, FAN = 4, 5, 6


@dataclass(frozen=True, slots=True, eq=False)
class Primitive:
    """Triangles of a mesh of the asset."""

    where: str
    mode: int
    positions: int  # accessor
    indices: int | None  # accessor
    corners: int  # how many vertices it goes through
    attributes: Item  # all accessors of vertices, by what they are

    @property
    def face_count(self) -> int:
        return self.corners // 3 if self.mode == TRIANGLES else max(self.corners - 2, 0)
