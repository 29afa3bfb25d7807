"""Segmentation on this machine, in a process of a Python that has Cleave."""

import json
import os
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from .errors import CleaveError
from .levels import Levels, levels_from
from .local_program import ERROR, HIERARCHY, LABELS, MESH, MISSING, REFUSED, STATE
from .work import Watch

_POLL_S = 0.1
_PROGRAM = Path(__file__).with_name("local_program.py")
_FOREIGN = ("PYTHONHOME", "PYTHONPATH", "PYTHONSTARTUP")  # may be meant for another Python, as Blender ignores them


@dataclass(frozen=True, slots=True)
class LocalPython:
    """A Python, the options that it is started with, and a folder of packages for it alone."""

    executable: str
    options: Sequence[str] = ()
    packages: str = ""  # empty if Cleave is installed in the Python itself

    def install_command(self) -> str:
        """The command that installs Cleave for this Python."""
        target = f' --target "{self.packages}"' if self.packages else ""
        return f'"{self.executable}" -m pip install{target} cleave-mesh'

    def segment(self, ply: bytes, faces: int, name: str, watch: Watch) -> Levels:
        """Return the levels of a mesh, a PLY file.

        Raises
        ------
        CleaveError
            If Cleave is not installed or cannot segment the mesh, or at the end of the time.
        CanceledError
            If the work is stopped.
        """
        watch.state = f"segmenting {name}"
        with tempfile.TemporaryDirectory(prefix="cleave-") as folder:
            Path(folder, MESH).write_bytes(ply)
            self._run(Path(folder), name, watch)
            document = json.loads(Path(folder, HIERARCHY).read_bytes())
            return levels_from(document, Path(folder, LABELS).read_bytes(), faces)

    def _run(self, folder: Path, name: str, watch: Watch) -> None:
        # -P: the modules beside the program are no packages of the Python.
        command = [self.executable, *self.options, "-P", str(_PROGRAM), str(folder), self.packages]
        kept = {key: value for key, value in os.environ.items() if key not in _FOREIGN}
        try:
            with (folder / ERROR).open("wb") as errors:
                process = subprocess.Popen(command, env=kept, stdout=subprocess.DEVNULL, stderr=errors)
        except OSError as error:
            raise CleaveError(
                f"{self.executable} cannot be started ({error.strerror}): set Python in the preferences."
            ) from error
        try:
            while process.poll() is None:
                watch.state = _state(folder, name)
                watch.pause(_POLL_S)
        finally:
            if process.poll() is None:
                process.kill()
                process.wait()
        self._check(process.returncode, name, (folder / ERROR).read_text(encoding="utf-8", errors="replace"))

    def _check(self, status: int, name: str, errors: str) -> None:
        if status == MISSING:
            raise CleaveError(f"Cleave is not installed in this Python: run {self.install_command()}")
        last = errors.strip().rpartition("\n")[2]
        if status == REFUSED:
            raise CleaveError(f"{name}: {last}")
        if status != 0:
            raise CleaveError(f"{name}: the computation ended with status {status}: {last or 'no message'}")


def _state(folder: Path, name: str) -> str:
    try:
        return f"{name}: {(folder / STATE).read_text(encoding='ascii')}"
    except OSError:
        return f"segmenting {name}"
