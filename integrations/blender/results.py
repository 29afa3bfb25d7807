"""What is kept of a computation, for the next change in the redo panel."""

from dataclasses import dataclass

from .levels import Levels
from .local import LocalPython
from .server import Revision, Server
from .work import Watch


@dataclass(frozen=True, slots=True)
class Segmented:
    """The levels of a mesh, and the job and the URL of the server that found them, which are empty on this machine."""

    levels: Levels
    job: str = ""
    server: str = ""

    @property
    def faces(self) -> int:
        return len(self.levels.leaf)


@dataclass(frozen=True, slots=True)
class Corrected:
    """The newest revision of a job."""

    revision: Revision

    @property
    def faces(self) -> int:
        return len(self.revision.labels)


def segmented_here(python: LocalPython, ply: bytes, faces: int, name: str, watch: Watch) -> Segmented:
    return Segmented(python.segment(ply, faces, name, watch))


def segmented_on(server: Server, ply: bytes, faces: int, name: str, watch: Watch) -> Segmented:
    job = server.segment(ply, faces, name, watch)
    return Segmented(job.levels, job.id, server.url)


def corrected_on(server: Server, job: str, faces: int, watch: Watch) -> Corrected:
    return Corrected(server.newest_revision(job, faces, watch))
