"""Models that are several files: ZIP archives that contain one model, and the files beside a model in a folder."""

import posixpath
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from typing import NamedTuple, Protocol
from urllib.parse import unquote

from segcore.errors import UnsupportedFormat
from segcore.io.formats import FORMATS
from segcore.io.limits import ReadLimits
from segcore.io.source import read_source
from segcore.io.zip_members import ZipMembers, normal_name

_MOST_NAMED = 5  # meshes in a message
_OF_SYSTEMS = frozenset({"__macosx", "thumbs.db", "desktop.ini"})  # that operating systems add to archives and folders


class Companions(Protocol):
    """The files that belong to a model."""

    def read(self, uri: str) -> bytes | None:
        """Return the bytes of a file by its address relative to the model; None if the set does not have it.

        Raises
        ------
        InvalidMesh
            If the file is damaged.
        LimitExceeded
            If it is larger than the limits allow.
        """


class NoCompanions:
    """The companions of a model that is one file."""

    def read(self, _uri: str) -> bytes | None:
        return None


class ZipCompanions:
    """The files of an archive, by their addresses relative to one of them."""

    def __init__(self, members: ZipMembers, model: str) -> None:
        self._members = members
        self._folder = posixpath.dirname(model.replace("\\", "/"))

    def read(self, uri: str) -> bytes | None:
        name = name_in_set(self._folder, uri)
        return None if name is None or name not in self._members else self._members.read(name)


class FolderCompanions:
    """The files in the folder of a model and below it. Nothing outside of it is opened, through links neither."""

    def __init__(self, model: Path, limits: ReadLimits) -> None:
        self._folder = model.resolve().parent
        self._limits = limits

    def read(self, uri: str) -> bytes | None:
        file = self.path(uri)
        return None if file is None else read_source(file, self._limits)

    def path(self, uri: str) -> Path | None:
        """Return the file at an address, without links; None if there is none in the folder."""
        path = _relative_path(uri)
        try:
            file = (self._folder / path).resolve()
            return file if path and file.is_relative_to(self._folder) and file.is_file() else None
        except (OSError, ValueError, RuntimeError):  # too long, with a zero byte, or a circle of links
            return None


class ModelInArchive(NamedTuple):
    """The one model of a ZIP archive."""

    name: str  # of its file
    data: bytes
    companions: ZipCompanions


def model_in_archive(data: bytes, limits: ReadLimits) -> ModelInArchive:
    """Return the one mesh of a ZIP archive, which may contain other files beside it.

    Raises
    ------
    UnsupportedFormat
        If there is no mesh, or more than one.
    InvalidMesh
        If the archive is damaged.
    LimitExceeded
    """
    members = ZipMembers(data, limits, "ZIP archive")
    meshes = [name for name in members.names if is_mesh_name(name)]
    if not meshes:
        raise UnsupportedFormat(
            f"The ZIP archive contains no mesh, but {_listed(members.names) or 'nothing'}: add the mesh file to it."
        )
    if len(meshes) > 1:
        raise UnsupportedFormat(
            f"The ZIP archive contains {len(meshes)} meshes ({_listed(meshes)}): send one mesh with its files, or send "
            "the archive as a batch."
        )
    return ModelInArchive(meshes[0], members.read(meshes[0]), ZipCompanions(members, meshes[0]))


def model_in_folder(path: Path) -> Path:
    """Return the one mesh in a folder; a path that is no folder is returned as it is.

    Raises
    ------
    UnsupportedFormat
        If the folder has no mesh, or more than one.
    OSError
        If the folder cannot be read.
    """
    if not path.is_dir():
        return path
    files = sorted(file.name for file in path.iterdir() if file.is_file())
    meshes = [name for name in files if is_mesh_name(name)]
    if not meshes:
        raise UnsupportedFormat(f"The folder {path.name!r} contains no mesh, but {_listed(files) or 'nothing'}.")
    if len(meshes) > 1:
        raise UnsupportedFormat(
            f"The folder {path.name!r} contains {len(meshes)} meshes ({_listed(meshes)}): name one."
        )
    return path / meshes[0]


def is_mesh_name(name: str) -> bool:
    """Whether a file has the extension of a mesh format, and is not hidden or added by an operating system."""
    path = PurePosixPath(normal_name(name))
    extension = PurePosixPath(path.stem).suffix if path.suffix == ".gz" else path.suffix
    return not is_hidden(name) and any(extension in form.extensions for form in FORMATS.values())


def is_hidden(name: str) -> bool:
    """Whether a file or one of its folders is hidden or added by an operating system, so that it is left out."""
    return any(part.startswith(".") or part in _OF_SYSTEMS for part in PurePosixPath(normal_name(name)).parts)


def name_in_set(folder: str, uri: str) -> str | None:
    """Return the name of a file in a set by its address relative to a folder of the set; None if it is not inside."""
    path = _relative_path(uri)
    name = posixpath.normpath(posixpath.join(folder, path)) if path else ".."
    return None if name.split("/")[0] == ".." else name


def _relative_path(uri: str) -> str:
    """The path of an address, "" if it is not relative: with a scheme, a host, a drive or from the root."""
    path = unquote(uri).replace("\\", "/")
    return "" if path.startswith("/") or ":" in path.split("/")[0] else path


def _listed(names: Sequence[str]) -> str:
    shown = ", ".join(posixpath.basename(name)[:40] for name in names[:_MOST_NAMED])
    return shown + (", ..." if len(names) > _MOST_NAMED else "")
