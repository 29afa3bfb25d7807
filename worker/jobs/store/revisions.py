"""The revisions of a job: an object for each, written once and never changed.

An object contains the SHA-256 of the rest in hexadecimal and a line end, the record as JSON and a line end, and the
parts as of :mod:`segcore.io.edited.partition_file`. Whoever creates the object of a number has made that revision.
"""

import hashlib
from contextlib import suppress
from dataclasses import dataclass

from pydantic import TypeAdapter

from segcore import InvalidMesh, Partition
from segcore.io import decode_partition, encode_partition
from worker.jobs.objects.interface import ObjectStorage
from worker.jobs.revision import Revision
from worker.jobs.store.layout import REVISIONS, is_revision_number, job_key, revision_key, revision_number
from worker.jobs.store.records import Records

_REVISION = TypeAdapter(Revision)


class RevisionExists(Exception):  # noqa: N818
    """Another edit has made the revision of this number."""


class UnknownRevision(LookupError):  # noqa: N818
    """The job has no revision of this number."""


class RevisionDamaged(LookupError):  # noqa: N818
    """The bytes of a revision are not those that were written."""


@dataclass(frozen=True, slots=True)
class RevisionPage:
    """Consecutive revisions of a job, newest first."""

    revisions: list[Revision]
    next: int | None  # older ones than this follow; None if there are none


class Revisions:
    """Reads and writes revisions; a write raises UnknownJob if the job has been deleted, also during the write."""

    def __init__(self, objects: ObjectStorage, records: Records) -> None:
        self._objects = objects
        self._records = records

    def newest(self, job_id: str) -> int:
        """Return the number of the newest revision of a job; 0 if there is none."""
        keys = self._objects.keys_below(job_key(job_id, REVISIONS), limit=1)
        return revision_number(keys[0]) if keys else 0

    def add(self, job_id: str, revision: Revision, partition: Partition) -> None:
        """Store a revision.

        Raises
        ------
        RevisionExists
            If there is one of this number.
        """
        key = revision_key(job_id, revision.number)
        content = _REVISION.dump_json(revision) + b"\n" + encode_partition(partition)
        self._records.require(job_id)
        is_new = self._objects.create(key, f"{_digest(content)}\n".encode() + content)
        self._records.require(job_id, lambda: self._objects.delete(key))
        self._records.forget_state(job_id)
        if not is_new:
            raise RevisionExists(revision.number)

    def revision(self, job_id: str, number: int) -> Revision:
        """Return the record of a revision.

        Raises
        ------
        UnknownRevision, RevisionDamaged
        """
        return _REVISION.validate_json(self._read(job_id, number)[0])

    def partition(self, job_id: str, number: int) -> Partition:
        """Return the parts of a revision.

        Raises
        ------
        UnknownRevision, RevisionDamaged
        """
        try:
            return decode_partition(self._read(job_id, number)[1])
        except InvalidMesh as error:
            raise RevisionDamaged(number) from error

    def page(self, job_id: str, before: int | None, limit: int) -> RevisionPage:
        """Return the newest revisions that are older than the number ``before``, newest first, without damaged ones."""
        after = "" if before is None else revision_key(job_id, before)
        numbers = [revision_number(key) for key in self._objects.keys_below(job_key(job_id, REVISIONS), after, limit)]
        found = self._objects.each(lambda number: self._undamaged(job_id, number), numbers)
        following = numbers[-1] if len(numbers) == limit and numbers[-1] > 1 else None
        return RevisionPage([revision for revision in found if revision is not None], following)

    def _undamaged(self, job_id: str, number: int) -> Revision | None:
        with suppress(RevisionDamaged):
            return self.revision(job_id, number)
        return None

    def _read(self, job_id: str, number: int) -> tuple[bytes, bytes]:
        """Return the record and the parts of a revision as they were written."""
        data = self._objects.get(revision_key(job_id, number)) if is_revision_number(number) else None
        if data is None:
            raise UnknownRevision(number)
        digest, _, content = data.partition(b"\n")
        if digest.decode("ascii", "replace") != _digest(content):
            raise RevisionDamaged(number)
        record, _, parts = content.partition(b"\n")
        return record, parts


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
