"""The process that edits: it keeps the Guides of the jobs that were edited last, and applies operations with them.

The service writes messages to its standard input and reads the answers from its standard output. The first message has
the settings. Each further one has ``job_id`` and ``edit`` (an EditDocument; null if only the Guide is to be made), and
the parts before the edit as data. Its answer has the parts after the edit as data, or ``code`` and ``message`` of an
error; ``held`` lists the jobs whose Guides are in memory.
"""

import os
import sys
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeAlias

from cleave.logs import configure_logging
from cleave.parent_death import die_with_parent
from cleave.settings import Settings
from segcore import CleaveError, Partition
from segcore.edit.operations import apply_all
from segcore.edit.tools import PartFinder, Tools
from segcore.io import Segmentation, decode_partition, encode_partition
from segcore.kernels import SEGMENT, compile_kernels
from service.edit.messages import Message, read_message, write_message
from service.edit.parts import parts_of
from service.result_cache import ResultCache
from worker.edits.operation_documents import EditDocument
from worker.edits.perform import guide_of
from worker.jobs.store.opening import open_store
from worker.jobs.store.revisions import RevisionDamaged, UnknownRevision
from worker.jobs.store.store import JobStore, UnknownJob
from worker.process.work_horse import limit_resources

GuideOf: TypeAlias = Callable[[Segmentation], PartFinder]

_FACE_BYTES = 400  # of a Guide and its mesh
_UNLIMITED_CPU_S = 10**9  # the service limits the time of each edit


@dataclass(slots=True)
class Guides:
    """The Guides that were used last, of a limited size; the last one is always kept."""

    max_bytes: int
    _held: OrderedDict[str, tuple[PartFinder, int]] = field(default_factory=OrderedDict)

    def get(self, job_id: str, make: Callable[[], tuple[PartFinder, int]]) -> PartFinder:
        """Return the Guide of a job; ``make`` returns it and its size in bytes if it is not held."""
        if job_id not in self._held:
            self._held[job_id] = make()
        self._held.move_to_end(job_id)
        while len(self._held) > 1 and sum(size for _, size in self._held.values()) > self.max_bytes:
            self._held.popitem(last=False)
        return self._held[job_id][0]

    def job_ids(self) -> list[str]:
        return list(self._held)


class Editor:
    """Applies edits to the jobs of a store."""

    def __init__(self, store: JobStore, settings: Settings, guide_of: GuideOf) -> None:
        self._store = store
        self._results = ResultCache(store, settings.result_cache_bytes, 0)
        self._guides = Guides(settings.edit_cache_bytes)
        self._guide_of = guide_of

    def answer(self, message: Message) -> Message:
        """Return the answer to a message; expected errors are answers too."""
        try:
            after = self._edited(message)
        except (CleaveError, UnknownRevision, RevisionDamaged, UnknownJob, MemoryError) as error:
            sentence = str(error) if isinstance(error, CleaveError) else None
            return Message({"code": _code_of(error), "message": sentence, "held": self._guides.job_ids()})
        return Message({"held": self._guides.job_ids()}, b"" if after is None else encode_partition(after))

    def _edited(self, message: Message) -> Partition | None:
        job_id = message.document["job_id"]
        if message.document["edit"] is None:  # only the Guide is wanted
            self._guide(job_id)
            return None
        operations = EditDocument.model_validate(message.document["edit"]).all()
        tools = Tools(lambda: self._guide(job_id), lambda number, level: parts_of(self._results, job_id, number, level))
        return apply_all(decode_partition(message.data), operations, tools)

    def _guide(self, job_id: str) -> PartFinder:
        return self._guides.get(job_id, lambda: self._made(job_id))

    def _made(self, job_id: str) -> tuple[PartFinder, int]:
        if self._store.records.job(job_id) is None:
            raise UnknownJob(job_id)
        result = self._results.get(job_id)
        return self._guide_of(result), _FACE_BYTES * len(result.mesh.faces)


def main(guide_of: GuideOf = guide_of) -> None:
    """Answer messages until the standard input ends."""
    die_with_parent(os.getppid())
    source, target = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # whatever prints does not disturb the answers
    settings = Settings.model_validate(read_message(source).document)
    configure_logging(settings.log_level, settings.log_format, "editor")
    compile_kernels([SEGMENT, "edit"])
    own_limits = {"job_memory_bytes": settings.edit_memory_bytes, "job_cpu_s": _UNLIMITED_CPU_S}
    limit_resources(settings.model_copy(update=own_limits))
    editor = Editor(open_store(settings), settings, guide_of)
    while True:
        try:
            message = read_message(source)
        except EOFError:
            return
        write_message(target, editor.answer(message))


def _code_of(error: Exception) -> str:
    codes: dict[type[Exception], str] = {
        UnknownRevision: "revision_not_found",
        RevisionDamaged: "revision_damaged",
        UnknownJob: "job_not_found",
        MemoryError: "out_of_memory",
    }
    return error.code if isinstance(error, CleaveError) else codes[type(error)]


if __name__ == "__main__":
    main()
