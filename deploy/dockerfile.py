"""A parser of Dockerfiles: stages, and the instructions of each stage in their order."""

import json
import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field

_CONTINUED = re.compile(r"\\\s*\n")
_VARIABLE = re.compile(r"\$(?:\{(\w+)\}|(\w+))")
_EXECUTED = ("FROM", "RUN", "COPY", "ENV", "WORKDIR", "USER")
_METADATA = ("VOLUME", "EXPOSE", "STOPSIGNAL", "HEALTHCHECK", "ENTRYPOINT", "CMD", "LABEL")


class UnknownInstruction(ValueError):  # noqa: N818
    """The Dockerfile has an instruction that this parser does not support."""


@dataclass(frozen=True, slots=True)
class Instruction:
    name: str  # in capitals
    text: str  # the rest of the instruction, on one line

    def words(self) -> list[str]:
        """Split the text, which is a JSON array or a command line."""
        return list(json.loads(self.text)) if self.text.startswith("[") else shlex.split(self.text)

    def flags(self) -> dict[str, str]:
        """Return the options, such as ``--from=build``."""
        leading = [word for word in self.text.split() if word.startswith("--")]
        return dict(word[2:].split("=", 1) for word in leading)

    def arguments(self) -> list[str]:
        """Return the words that are not options."""
        return [word for word in self.words() if not word.startswith("--")]


@dataclass(slots=True)
class Stage:
    name: str
    base: str
    instructions: list[Instruction] = field(default_factory=list)

    def last(self, name: str) -> Instruction:
        """Return the last instruction of a name, which overrides the earlier ones.

        Raises
        ------
        UnknownInstruction
            If there is none.
        """
        found = [instruction for instruction in self.instructions if instruction.name == name]
        if not found:
            raise UnknownInstruction(f"The stage {self.name!r} has no {name}.")
        return found[-1]


def parse(text: str) -> list[Stage]:
    """Return the stages of a Dockerfile.

    Raises
    ------
    UnknownInstruction
        If an instruction is not supported.
    """
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    stages: list[Stage] = []
    for line in _CONTINUED.sub(" ", "\n".join(lines)).splitlines():
        name, _, rest = line.strip().partition(" ")
        if not name:
            continue
        if name not in (*_EXECUTED, *_METADATA) or (name != "FROM" and not stages):
            raise UnknownInstruction(f"{name} is not supported.")
        if name == "FROM":
            base, *alias = rest.split()
            stages.append(Stage(alias[1] if alias else str(len(stages)), base))
        else:
            stages[-1].instructions.append(Instruction(name, " ".join(rest.split())))
    return stages


def assignments(instruction: Instruction, environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that an ENV instruction sets; references are expanded in the environment before it."""
    pairs = (word.split("=", 1) for word in instruction.words())
    return {name: expand(value, environment) for name, value in pairs}


def expand(text: str, environment: Mapping[str, str]) -> str:
    """Expand ``$NAME`` and ``${NAME}``; an unknown variable is empty."""
    return _VARIABLE.sub(lambda match: environment.get(match[1] or match[2], ""), text)
