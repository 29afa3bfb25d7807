"""The results of a batch as one ZIP archive, written while it is sent."""

import io
import json
import zipfile
from collections.abc import Iterator, Sequence
from typing import BinaryIO

from segcore.io.gltf.writer import write_glb
from segcore.io.labels import write_seg
from segcore.levels import Fineness
from service.answer.label_formats import compact_json
from service.context import Context
from service.documents import JobDocument
from service.lookup import result_of
from service.result_documents import hierarchy_of
from worker.jobs.job import Job
from worker.jobs.store.store import UnknownJob

ZIP = "application/zip"
_PIECE_BYTES = 256 * 1024


class _Outlet(io.RawIOBase):
    """A file that is read away while it is written."""

    def __init__(self) -> None:
        self._written = bytearray()

    def writable(self) -> bool:
        return True

    def write(self, data: object) -> int:
        self._written += memoryview(data)  # type: ignore[arg-type]
        return len(memoryview(data))  # type: ignore[arg-type]

    def take(self) -> bytes:
        taken = bytes(self._written)
        self._written.clear()
        return taken

    def __len__(self) -> int:
        return len(self._written)


def batch_archive(context: Context, jobs: Sequence[tuple[Job, JobDocument]], fineness: Fineness) -> Iterator[bytes]:
    """A folder for every job: its document, and where it succeeded its labels, hierarchy and model."""
    outlet = _Outlet()
    with zipfile.ZipFile(outlet, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for number, (job, document) in enumerate(jobs, start=1):
            folder = f"{number:04d}-{_folder_name(job)}"
            archive.writestr(f"{folder}/job.json", json.dumps(document.model_dump(mode="json"), indent=1))
            if document.status == "succeeded":
                try:
                    _write_result(archive, folder, context, job, fineness)
                except UnknownJob:
                    archive.writestr(f"{folder}/DELETED", "")
            if len(outlet) > _PIECE_BYTES:
                yield outlet.take()
    yield outlet.take()


def _write_result(archive: zipfile.ZipFile, folder: str, context: Context, job: Job, fineness: Fineness) -> None:
    result = result_of(context, job)
    most = result.hierarchy.max_segments
    count = most if (fineness.segments or 0) > most else fineness.segments_of(result.hierarchy)
    with archive.open(f"{folder}/labels.seg", "w") as target:
        write_seg(_as_binary(target), result.hierarchy.labels(count))
    archive.writestr(f"{folder}/hierarchy.json", compact_json(hierarchy_of(result)))
    with archive.open(f"{folder}/model.glb", "w", force_zip64=True) as target:
        write_glb(_as_binary(target), result.mesh, result.hierarchy, count)


def _as_binary(target: object) -> BinaryIO:
    return target  # type: ignore[return-value]


def _folder_name(job: Job) -> str:
    """Letters, digits and a few signs of the client's name for the mesh: no archive program can go astray."""
    stem = (job.file_name or job.id).rpartition(".")[0] or (job.file_name or job.id)
    return "".join(sign if sign.isascii() and (sign.isalnum() or sign in "-_") else "_" for sign in stem)[:80]
