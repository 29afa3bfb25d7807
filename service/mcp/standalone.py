"""A service of its own for `cleave mcp`: `cleave serve` on a free port of this machine."""

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from cleave.parent_death import die_with_parent

_LISTENING = re.compile(r"listening on +(http://\S+)")
_GRACE_S = 15.0  # for running jobs to be handed back; set by hand
# Settings that would make it a part of another installation, or require keys.
_OF_OTHERS = ("API_KEYS", "API_KEYS_FILE", "AUTH", "REDIS_URL", "ROOT_PATH", "STORE_URL", "DATA_DIR")


class CannotServe(Exception):  # noqa: N818
    """The service has not started; it has said why."""


@contextmanager
def own_service(data_dir: Path | None) -> Iterator[str]:
    """Run a service and yield its URL.

    Parameters
    ----------
    data_dir : keeps its jobs; None for a temporary folder.

    Raises
    ------
    CannotServe
        If it does not start.
    """
    with tempfile.TemporaryDirectory(prefix="cleave-mcp-", ignore_cleanup_errors=True) as temporary:
        folder = temporary if data_dir is None else str(data_dir)
        environment = {name: value for name, value in os.environ.items() if not _is_of_others(name)}
        process = subprocess.Popen(
            [sys.executable, "-m", "service.commands", "serve", "--port", "0", "--data-dir", folder],
            env=environment,
            stdin=subprocess.DEVNULL,  # standard input and output belong to the protocol
            stdout=subprocess.PIPE,
            text=True,
            preexec_fn=partial(die_with_parent, os.getpid()),
        )
        try:
            yield _url(process)
        finally:
            process.terminate()
            try:
                process.wait(_GRACE_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _is_of_others(name: str) -> bool:
    return name.removeprefix("CLEAVE_") in _OF_OTHERS and name.startswith("CLEAVE_")


def _url(process: "subprocess.Popen[str]") -> str:
    assert process.stdout is not None
    for line in process.stdout:
        found = _LISTENING.search(line)
        if found:
            return found[1]
    raise CannotServe(f"The service ended with status {process.wait()}: see the line above.")
