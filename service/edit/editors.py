"""The processes in which the service computes edits, so that its event loop and other requests do not wait for them."""

import asyncio
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field

from cleave.settings import Settings
from service.edit.editor_process import EditorFailed, EditorProcess
from service.edit.messages import Message

PROGRAM: Sequence[str] = ("-m", "service.edit.program")


class GuideNotReady(Exception):  # noqa: N818
    """The Guide of a job is still being made."""


@dataclass(slots=True, eq=False)
class _Slot:
    """A process, the thread that talks to it, and what is known about it."""

    process: EditorProcess
    thread: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1, "editor"))
    held: frozenset[str] = frozenset()  # jobs whose Guides it has in memory
    waiting: int = 0  # messages that are not answered


class Editors:
    """Several processes; the edits of a job go to the one that has its Guide in memory."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._slots = [_Slot(EditorProcess(settings, PROGRAM)) for _ in range(settings.edit_processes)]
        self._warming: dict[str, Future[Message]] = {}

    def holds(self, job_id: str) -> bool:
        """Whether a Guide of a job is in memory."""
        return any(job_id in slot.held for slot in self._slots)

    async def ask(self, job_id: str, message: Message) -> Message:
        """Return the answer to a message about a job, whose Guide is made first if it is not in memory.

        Raises
        ------
        GuideNotReady
            If the Guide is not made within the time of the settings, and the process goes on; or if the process was
            ended by an edit before this one.
        EditorFailed
            If there is no answer within that time, that for edits before it included.
        """
        limit_s = self._settings.edit_timeout_s
        if not self.holds(job_id):
            making = asyncio.wrap_future(self._warm_up(job_id))
            making.add_done_callback(_note_error)
            try:
                made = await asyncio.wait_for(asyncio.shield(making), limit_s)
            except TimeoutError:
                raise GuideNotReady from None
            if "code" in made.document:
                return made
        future = self._submit(self._slot_for(job_id), message, limit_s)
        try:
            return await asyncio.wait_for(asyncio.wrap_future(future), limit_s)
        except TimeoutError:
            raise EditorFailed from None

    def _warm_up(self, job_id: str) -> "Future[Message]":
        """Begin to make the Guide of a job, unless that has begun."""
        if job_id not in self._warming:
            future = self._submit(
                self._slot_for(job_id), Message({"job_id": job_id, "edit": None}), self._settings.job_timeout_s
            )
            self._warming[job_id] = future
            future.add_done_callback(lambda _: self._warming.pop(job_id, None))
        return self._warming[job_id]

    def stop(self) -> None:
        """End the processes."""
        for slot in self._slots:
            slot.thread.shutdown(wait=False, cancel_futures=True)  # first, so that no message starts a process again
            slot.process.stop()

    def _slot_for(self, job_id: str) -> _Slot:
        holding = [slot for slot in self._slots if job_id in slot.held]
        return min(holding or self._slots, key=lambda slot: slot.waiting)

    def _submit(self, slot: _Slot, message: Message, limit_s: float) -> "Future[Message]":
        def ask() -> Message:
            if message.document["edit"] is not None and message.document["job_id"] not in slot.held:
                raise GuideNotReady
            try:
                answer = slot.process.ask(message, limit_s)
            except EditorFailed:
                slot.held = frozenset()
                raise
            slot.held = frozenset(answer.document["held"])
            return answer

        slot.waiting += 1
        future = slot.thread.submit(ask)
        future.add_done_callback(lambda _: _leave(slot))
        return future


def _note_error(made: "asyncio.Future[Message]") -> None:
    """Take the error of a Guide for which no request waits any longer."""
    if not made.cancelled():
        made.exception()


def _leave(slot: _Slot) -> None:
    slot.waiting -= 1
