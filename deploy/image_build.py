"""Builds the stages of a Dockerfile in folders, without a container engine."""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from deploy.context import is_sent, read_patterns
from deploy.dockerfile import Instruction, Stage, assignments, expand, parse
from deploy.roots import Root, copy_into, copy_of

Say = Callable[[str], None]

_PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"


@dataclass(slots=True)
class BuiltStage:
    """The root of a stage, and the environment, folder and user of its commands."""

    stage: Stage
    root: Root
    environment: dict[str, str] = field(default_factory=lambda: {"PATH": _PATH})
    folder: str = "/"
    user: str = "0:0"


@dataclass(frozen=True, slots=True)
class Builder:
    """Builds a Dockerfile."""

    context: Path  # the folder of the Dockerfile
    base: Path  # a root that is used instead of the base image of every stage
    work: Path  # folder of the roots of the stages
    binds: tuple[Path, ...]  # files and folders of this machine that commands can read, to find the package index
    variables: Mapping[str, str]  # environment variables of commands, for the same purpose
    say: Say

    def build(self) -> BuiltStage:
        """Build every stage, and return the last one, which is the image."""
        built: dict[str, BuiltStage] = {}
        for number, stage in enumerate(parse((self.context / "Dockerfile").read_text())):
            built[stage.name] = self._build_stage(stage, number, built)
        return built[stage.name]

    def _build_stage(self, stage: Stage, number: int, before: Mapping[str, BuiltStage]) -> BuiltStage:
        self.say(f"stage {stage.name}: {stage.base}, replaced by {self.base}")
        made = BuiltStage(stage, copy_of(self.base, self.work / f"stage-{number}"))
        made.root.mount_system()
        made.root.bind_network()
        for path in self.binds:
            made.root.bind(path, str(path))
        for instruction in stage.instructions:
            self.say(f"  {instruction.name} {instruction.text}")
            self._execute(instruction, made, before)
        return made

    def _execute(self, instruction: Instruction, made: BuiltStage, before: Mapping[str, BuiltStage]) -> None:
        match instruction.name:
            case "RUN":
                words = ["/bin/sh", "-c", instruction.text]
                made.root.run(words, {**made.environment, **self.variables}, made.folder, made.user)
            case "COPY":
                self._copy(instruction, made, before)
            case "ENV":
                made.environment |= assignments(instruction, made.environment)
            case "WORKDIR":
                made.folder = expand(instruction.text, made.environment)
                made.root.path(made.folder).mkdir(parents=True, exist_ok=True)
            case "USER":
                made.user = instruction.text

    def _copy(self, instruction: Instruction, made: BuiltStage, before: Mapping[str, BuiltStage]) -> None:
        *sources, target = instruction.arguments()
        folder = made.root.path(os.path.join(made.folder, target))
        stage = instruction.flags().get("from")
        for source in sources:
            if stage is not None:
                copy_into(before[stage].root.path(source), folder)
            else:
                self._copy_from_context(source, folder)

    def _copy_from_context(self, source: str, target: Path) -> None:
        """Copy a file, or the content of a folder, into a folder; files that .dockerignore excludes are skipped."""
        patterns = read_patterns(self.context / ".dockerignore")
        path = self.context / source
        files = [path] if path.is_file() else sorted(file for file in path.rglob("*") if file.is_file())
        sent = [file for file in files if is_sent(str(file.relative_to(self.context)), patterns)]
        if not sent:
            raise FileNotFoundError(f"COPY {source}: .dockerignore excludes all of it.")
        for file in sent:
            copy_into(file, target / file.relative_to(path if path.is_dir() else path.parent))
