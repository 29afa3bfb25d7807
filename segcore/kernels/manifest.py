"""The list of the kernels that are called from Python, in groups by what needs them."""

import json
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

PATH = Path(__file__).with_name("manifest.json")

# In the order in which they are compiled; :mod:`segcore.kernels.tasks` has a task that needs each.
GROUPS = ("read", "segment", "bodies", "fine", "draw", "edit", "solvers")
READ, SEGMENT, *_ = GROUPS
FIRST = (READ, SEGMENT)  # to read and segment a mesh with the default parameters


@dataclass(frozen=True, slots=True)
class Kernel:
    """A kernel for some types of arguments."""

    group: str  # the first one that calls it
    place: str  # package.module:name
    arguments: list[Any]  # types, as :mod:`segcore.kernels.signatures` writes them
    size: int  # bytes of its bytecode and that of the kernels that it calls; compilation takes longer for more

    def compile(self) -> None:
        """Compile the kernel, or load it from the cache."""
        from segcore.kernels.signatures import decode, named

        named(self.place).compile(tuple(map(decode, self.arguments)))


@cache
def kernels() -> tuple[Kernel, ...]:
    """Return the kernels of all groups."""
    return tuple(Kernel(**entry) for entry in json.loads(PATH.read_text()))


def write_kernels(found: list[Kernel]) -> None:
    """Write the list, a line for each kernel."""
    lines = ",\n".join(json.dumps(asdict(kernel)) for kernel in found)
    PATH.write_text(f"[\n{lines}\n]\n")
