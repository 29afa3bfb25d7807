"""The results of a batch as a ZIP archive that is streamed while it is written."""

import io
import json
import zipfile
from collections.abc import Iterator, Sequence
from typing import BinaryIO

from segcore.io import WRITERS, Segmentation
from segcore.levels import Fineness
from service.answer.label_formats import hierarchy_json
from service.context import Context
from service.job_documents import JobDocument
from service.lookup import result_of
from worker.jobs.job import Job
from worker.jobs.store.store import UnknownJob

ZIP = "application/zip"
_CHUNK_BYTES = 256 * 1024


class _Buffer(io.RawIOBase):
    """A write-only file; what was written is removed by :meth:`take`."""

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
    """Yield an archive with a folder per job: its document and, if it succeeded, its labels, hierarchy and model."""
    buffer = _Buffer()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for number, (job, document) in enumerate(jobs, start=1):
            folder = f"{number:04d}-{_folder_name(job)}"
            archive.writestr(f"{folder}/job.json", json.dumps(document.model_dump(mode="json"), indent=1))
            if document.status == "succeeded":
                try:
                    _write_result(archive, folder, result_of(context, job), fineness)
                except UnknownJob:
                    archive.writestr(f"{folder}/DELETED", "")
            if len(buffer) > _CHUNK_BYTES:
                yield buffer.take()
    yield buffer.take()


def _write_result(archive: zipfile.ZipFile, folder: str, result: Segmentation, fineness: Fineness) -> None:
    most = result.hierarchy.max_segments
    count = most if (fineness.segments or 0) > most else fineness.segments_of(result.hierarchy)
    with archive.open(f"{folder}/labels.seg", "w") as target:
        WRITERS["seg"].write(_as_binary(target), result.mesh, result.hierarchy, count)
    archive.writestr(f"{folder}/hierarchy.json", hierarchy_json(result))
    with archive.open(f"{folder}/model.glb", "w", force_zip64=True) as target:
        WRITERS["glb"].write(_as_binary(target), result.mesh, result.hierarchy, count)


def _as_binary(target: object) -> BinaryIO:
    return target  # type: ignore[return-value]


def _folder_name(job: Job) -> str:
    """Return the file name with ASCII alphanumerics, hyphens and underscores only: safe in every archive program."""
    stem = (job.file_name or job.id).rpartition(".")[0] or (job.file_name or job.id)
    return "".join(sign if sign.isascii() and (sign.isalnum() or sign in "-_") else "_" for sign in stem)[:80]
