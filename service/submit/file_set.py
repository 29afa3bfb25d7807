"""Models that are sent as several files: each becomes one ZIP archive, which is stored as the mesh of its job."""

import io
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple, NoReturn

from segcore.io import is_hidden, is_mesh_name, name_in_set, referenced_files
from service.problems import Problem
from service.submit.form import ReceivedMesh, refuse_size
from worker.jobs.store.upload import MeshUpload

MOST_FILES = 1000  # of one model; set by hand: a scan has hundreds of pictures
_MOST_NAMED = 5  # files in a message
_LONGEST_NAME = 1000  # characters of a name with its folders
_DATE = (1980, 1, 1, 0, 0, 0)  # the first of the format, the same for all: equal sets have equal bytes
_CHUNK_BYTES = 1024 * 1024

BeginUpload = Callable[[], MeshUpload]


class Models(NamedTuple):
    """The models of a batch."""

    meshes: list[ReceivedMesh]
    left_out: list[str]  # the names of files that no model refers to


def one_model(files: Sequence[ReceivedMesh], begin_upload: BeginUpload, max_bytes: int) -> ReceivedMesh:
    """Return the mesh of a form for one job: its only file, or an archive of its only mesh and the files beside it.

    Raises
    ------
    Problem
        If there is not exactly one mesh, a name cannot be used, or the files are too large together.
    """
    if len(files) == 1:
        return files[0]
    members = _members(files)
    models = [name for name in members if is_mesh_name(name)]
    if not models:
        _refuse(f"None of the files is a mesh by its extension: {_listed(list(members))}.")
    if len(models) > 1:
        _refuse(
            f"The form has {len(models)} meshes ({_listed(models)}): send one mesh with the files that it refers to, "
            "or many meshes to /v1/batches."
        )
    if members[models[0]].size_bytes == 0:
        raise Problem("invalid_mesh")
    return ReceivedMesh(_archive(members, begin_upload, max_bytes), models[0], is_set=True)


def models_of(files: Sequence[ReceivedMesh], begin_upload: BeginUpload, max_bytes: int, max_set_bytes: int) -> Models:
    """Return the models of a batch, in its order, each with the files of the batch that it refers to.

    A file is a model if its name has no extension or that of a mesh or a ZIP archive, and does not begin with a dot.

    Parameters
    ----------
    max_bytes : of all models that have other files beside them.
    max_set_bytes : of one of them.

    Raises
    ------
    Problem
        If a name cannot be used, or a model with its files is too large.
    """
    models, beside = list(filter(_is_model, files)), [file for file in files if not _is_model(file)]
    others = _members([file for file in beside if _inside(file.file_name) is not None])
    outside = [file.file_name or "" for file in beside if _inside(file.file_name) is None]
    if not models:
        _refuse(f"None of the files is a mesh by its extension: {_listed([*others, *outside]) or 'all are hidden'}.")
    if not others:
        return Models(models, outside)
    meshes, used = [], set[str]()
    for model in models:
        members = _referenced(model, others)
        used.update(members)
        meshes.append(_with_files(model, members, begin_upload, min(max_bytes, max_set_bytes)))
        max_bytes -= meshes[-1].upload.size_bytes if members else 0
    return Models(meshes, [*(name for name in others if name not in used), *outside])


def _is_model(file: ReceivedMesh) -> bool:
    name = PurePosixPath((file.file_name or "").replace("\\", "/")).name
    suffix = PurePosixPath(name).suffix.lower()
    return not is_hidden(name) and (suffix in ("", ".gz", ".zip") or is_mesh_name(name))


def _referenced(model: ReceivedMesh, others: dict[str, MeshUpload]) -> dict[str, MeshUpload]:
    """The files that a model refers to, by their names."""
    folder = str(PurePosixPath((model.file_name or "").replace("\\", "/")).parent)
    known = {name.lower(): name for name in others}

    def name_at(address: str) -> str | None:
        return known.get((name_in_set(folder, address) or "").lower())

    def locate(address: str) -> Path | None:
        name = name_at(address)
        return None if name is None else others[name].path

    found = referenced_files(model.upload.path, model.file_name or "", locate)
    names = [name for address in found if (name := name_at(address)) is not None]
    return {name: others[name] for name in names}


def _with_files(
    model: ReceivedMesh, members: dict[str, MeshUpload], begin_upload: BeginUpload, max_bytes: int
) -> ReceivedMesh:
    if not members or model.upload.size_bytes == 0:
        return model
    name = _checked_name(model.file_name)
    return ReceivedMesh(_archive(members | {name: model.upload}, begin_upload, max_bytes), name, is_set=True)


def _members(files: Sequence[ReceivedMesh]) -> dict[str, MeshUpload]:
    """The files that are not hidden, by their names in the set."""
    members: dict[str, MeshUpload] = {}
    known = set[str]()
    for file in files:
        name = _checked_name(file.file_name)
        if is_hidden(name):
            continue
        if name.lower() in known:
            _refuse(f"Two files are called {name[:80]!r}, if case does not matter: name them differently.")
        known.add(name.lower())
        members[name] = file.upload
    return members


def _checked_name(name: str | None) -> str:
    inside = _inside(name)
    if inside is None:
        _refuse(
            f"The file name {(name or '')[:80]!r} cannot be used: each file of a set needs a relative path inside the "
            "set as its name."
        )
    return inside


def _inside(name: str | None) -> str | None:
    """Return the name of a file in its set, a relative path; None if it is not inside, or cannot be a name."""
    inside = name_in_set("", (name or "").replace("%", "%25"))
    return inside if inside and inside != "." and len(inside) <= _LONGEST_NAME and inside.isprintable() else None


def _archive(members: dict[str, MeshUpload], begin_upload: BeginUpload, max_bytes: int) -> MeshUpload:
    """Return an archive of files without compression, whose bytes depend on their names and contents alone."""
    if len(members) > MOST_FILES:
        raise Problem("too_large", f"The model has {len(members)} files: at most {MOST_FILES} can belong to one.")
    if sum(upload.size_bytes for upload in members.values()) > max_bytes:
        refuse_size(max_bytes)
    packed = begin_upload()
    with zipfile.ZipFile(_Appended(packed), "w", zipfile.ZIP_STORED) as archive:
        for name in sorted(members):
            entry = zipfile.ZipInfo(name, _DATE)
            entry.create_system = 3  # Unix, on every system
            with archive.open(entry, "w", force_zip64=True) as target, members[name].path.open("rb") as source:
                while chunk := source.read(_CHUNK_BYTES):
                    target.write(chunk)
    packed.close()
    return packed


class _Appended(io.RawIOBase):
    """An upload as a file that is written from its beginning to its end."""

    def __init__(self, upload: MeshUpload) -> None:
        self._upload = upload

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        self._upload.write(data)
        return len(data)


def _listed(names: Sequence[str]) -> str:
    shown = ", ".join(name[-40:] for name in names[:_MOST_NAMED])
    return shown + (", ..." if len(names) > _MOST_NAMED else "")


def _refuse(sentence: str) -> NoReturn:
    raise Problem("invalid_file_set", sentence)
