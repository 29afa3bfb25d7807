"""One process of :mod:`service.edit.program`, started at its first edit and again after it was killed or has died."""

import logging
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress

from cleave.settings import Settings
from service.edit.messages import Message, read_message, write_message

log = logging.getLogger("cleave.service")


class EditorFailed(Exception):  # noqa: N818
    """The process has no answer: it was killed after its time was over, it has died, or it has too little memory.

    It is started again for the next edit if it has ended.
    """


class EditorProcess:
    """Sends messages to the process and waits for its answers, from one thread at a time."""

    def __init__(self, settings: Settings, program: Sequence[str]) -> None:
        self._settings = settings
        self._program = program
        self._process: subprocess.Popen[bytes] | None = None

    def ask(self, message: Message, limit_s: float) -> Message:
        """Return the answer to a message.

        Raises
        ------
        EditorFailed
            If there is none within the time.
        """
        process = self._process or self._started()
        killer = threading.Timer(limit_s, process.kill)  # also if it does not read, so that a write does not end
        killer.daemon = True
        killer.start()
        try:
            write_message(process.stdin, message)
            return read_message(process.stdout)
        except (OSError, EOFError) as error:
            if self._process is process:  # else it was stopped
                log.warning("the process of edits was killed after %g s, or has died", limit_s)
            self.stop()
            raise EditorFailed from error
        finally:
            killer.cancel()

    def stop(self) -> None:
        """Kill the process, if it runs; it has nothing to be saved."""
        process, self._process = self._process, None
        if process is not None:
            process.kill()
            with suppress(OSError), process:  # closes the pipes and waits
                pass

    def _started(self) -> "subprocess.Popen[bytes]":
        process = subprocess.Popen([sys.executable, *self._program], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._process = process
        with suppress(OSError):  # the first message meets the same error
            write_message(process.stdin, Message(self._settings.model_dump(mode="json")))
        return process
