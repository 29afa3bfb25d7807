"""ReadLimits: the largest mesh file that a reader accepts."""

from dataclasses import dataclass

from segcore.errors import InvalidParameters, LimitExceeded


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadLimits:
    """The largest input that is read; checked before memory is allocated for it.

    Raises
    ------
    InvalidParameters
        If a limit is not a positive integer.
    """

    # Set by hand, far above the usual meshes; the service replaces them by its settings.
    max_bytes: int = 2 * 2**30  # of the file as it was sent
    max_uncompressed_bytes: int = 2 * 2**30  # of the contents of a compressed file
    max_faces: int = 20_000_000  # triangles, after polygons are triangulated and instances expanded
    max_vertices: int = 60_000_000  # three for each face, as in STL

    def __post_init__(self) -> None:
        for name in self.__slots__:
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, int) or value < 1:
                raise InvalidParameters(f"{name} must be a positive integer, not {value!r}.")

    def check(self, name: str, value: int, what: str) -> None:
        """Raise LimitExceeded if ``value`` is above the limit called ``name``."""
        limit = getattr(self, name)
        if value > limit:
            raise LimitExceeded(
                f"The file has {value} {what}, more than {name} = {limit}: reduce the mesh or raise the limit."
            )

    def check_faces(self, count: int) -> None:
        self.check("max_faces", count, "faces")

    def check_vertices(self, count: int) -> None:
        self.check("max_vertices", count, "vertices")
