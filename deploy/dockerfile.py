"""What a Dockerfile says, as values: the instructions of each of its stages, in order."""

import json
import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field

_CONTINUED = re.compile(r"\\\s*\n")
_VARIABLE = re.compile(r"\$(?:\{(\w+)\}|(\w+))")
_CARRIED_OUT = ("FROM", "RUN", "COPY", "ENV", "WORKDIR", "USER")
_TOLD = ("VOLUME", "EXPOSE", "STOPSIGNAL", "HEALTHCHECK", "ENTRYPOINT", "CMD", "LABEL")


class UnknownInstruction(ValueError):  # noqa: N818
    """The Dockerfile has something that is not understood here."""


@dataclass(frozen=True, slots=True)
class Instruction:
    name: str  # in capitals
    text: str  # what follows, on one line

    def words(self) -> list[str]:
        """The parts of the text, of a JSON array as of a command line."""
        return list(json.loads(self.text)) if self.text.startswith("[") else shlex.split(self.text)

    def flags(self) -> dict[str, str]:
        """The options that come first, such as ``--from=build``."""
        leading = [word for word in self.text.split() if word.startswith("--")]
        return dict(word[2:].split("=", 1) for word in leading)

    def arguments(self) -> list[str]:
        """The words without the options."""
        return [word for word in self.words() if not word.startswith("--")]


@dataclass(slots=True)
class Stage:
    name: str
    base: str
    instructions: list[Instruction] = field(default_factory=list)

    def last(self, name: str) -> Instruction:
        """The instruction of a name that holds.

        Raises
        ------
        UnknownInstruction
            Where there is none.
        """
        found = [instruction for instruction in self.instructions if instruction.name == name]
        if not found:
            raise UnknownInstruction(f"The stage {self.name!r} has no {name}.")
        return found[-1]


def parse(text: str) -> list[Stage]:
    """The stages of a Dockerfile.

    Raises
    ------
    UnknownInstruction
        Where an instruction is not one of those that are understood here.
    """
    lines = [line for line in text.splitlines() if not line.lstrip().startswith("#")]
    stages: list[Stage] = []
    for line in _CONTINUED.sub(" ", "\n".join(lines)).splitlines():
        name, _, rest = line.strip().partition(" ")
        if not name:
            continue
        if name not in (*_CARRIED_OUT, *_TOLD) or (name != "FROM" and not stages):
            raise UnknownInstruction(f"{name} is not understood.")
        if name == "FROM":
            base, *alias = rest.split()
            stages.append(Stage(alias[1] if alias else str(len(stages)), base))
        else:
            stages[-1].instructions.append(Instruction(name, " ".join(rest.split())))
    return stages


def assignments(instruction: Instruction, environment: Mapping[str, str]) -> dict[str, str]:
    """The variables that an ENV sets; what it refers to has its value from before."""
    pairs = (word.split("=", 1) for word in instruction.words())
    return {name: expand(value, environment) for name, value in pairs}


def expand(text: str, environment: Mapping[str, str]) -> str:
    return _VARIABLE.sub(lambda match: environment.get(match[1] or match[2], ""), text)
