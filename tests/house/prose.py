"""Counts words in the prose of Python files: ``python tests/house/prose.py [--where] [PATH ...]``.

Prose is comments and strings of at least four words: docstrings and messages. The banned words are in words.tsv next to
this file, with the words to use instead; the prose and the names of modules, classes, functions and variables are
searched for them.
"""

import argparse
import ast
import csv
import io
import keyword
import re
import sys
import tokenize
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
SOURCES = ("cleave", "segcore", "worker", "service", "bench", "deploy", "tests")
LEAST_RATIO = 5  # of "if" to "where"; FastAPI, SciPy and others have 6 to 13
_LEAST_SPACES = 3
_WORDS_OF_NAME = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")


@dataclass(frozen=True, slots=True)
class Passage:
    """A comment, a string or a name."""

    path: Path
    line: int
    text: str

    def count(self, word: str) -> int:
        return len(re.findall(rf"\b{word}\b", self.text, re.IGNORECASE))

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {' '.join(self.text.split())[:100]}"


@dataclass(frozen=True, slots=True)
class Banned:
    """A word that must not be used."""

    pattern: re.Pattern[str]
    instead: str
    allowed: re.Pattern[str] | None  # phrases in which it may be used
    folder: re.Pattern[str] | None  # folders in which it must not be used; None for all
    example: str

    def is_in(self, passage: Passage) -> bool:
        if self.folder and not any(map(self.folder.fullmatch, _relative(passage.path).parts)):
            return False
        rest = self.allowed.sub("", passage.text) if self.allowed else passage.text
        return self.pattern.search(rest) is not None


def banned_words() -> list[Banned]:
    """Read words.tsv. A pattern with a capital is the name of a class, other patterns match in any case."""
    with Path(__file__).with_name("words.tsv").open(newline="", encoding="utf-8") as lines:
        return [_banned(row) for row in csv.DictReader(lines, delimiter="\t", quoting=csv.QUOTE_NONE)]


@dataclass(frozen=True, slots=True)
class Source:
    """The prose and the names of one file."""

    prose: list[Passage]  # comments, and strings of at least four words
    names: list[Passage]  # of the file and of everything in it, split into words


def read_source(path: Path) -> Source:
    """Read a Python file."""
    text = path.read_text(encoding="utf-8")
    tokens = list(tokenize.generate_tokens(io.StringIO(text).readline))
    prose = [Passage(path, token.start[0], token.string) for token in tokens if token.type == tokenize.COMMENT]
    strings = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Constant)]
    prose += [Passage(path, node.lineno, node.value) for node in strings if _is_prose(node.value)]
    names = [token for token in tokens if token.type == tokenize.NAME and not keyword.iskeyword(token.string)]
    passages = [Passage(path, token.start[0], _split(token.string)) for token in names]
    return Source(prose, [Passage(path, 1, _split(path.stem)), *passages])


def count_words(sources: Iterable[Source]) -> dict[str, int]:
    """Return how often "if" and "where" are in the prose."""
    prose = [passage for source in sources for passage in source.prose]
    return {word: sum(passage.count(word) for passage in prose) for word in ("if", "where")}


def find_banned(sources: Iterable[Source]) -> list[str]:
    """Return a line for every banned word in the prose and the names."""
    words = banned_words()
    return [
        f"{passage} (instead: {word.instead})"
        for source in sources
        for passage in [*source.prose, *source.names]
        for word in words
        if word.is_in(passage)
    ]


def read_sources(paths: Iterable[Path]) -> list[Source]:
    """Read files, and the Python files of folders."""
    files = [file for path in paths for file in (sorted(path.rglob("*.py")) if path.is_dir() else [path])]
    return [read_source(file) for file in files if "node_modules" not in file.parts]


def _banned(row: dict[str, str]) -> Banned:
    return Banned(
        pattern=re.compile(rf"\b({row['pattern']})\b", 0 if row["pattern"][0].isupper() else re.IGNORECASE),
        instead=row["instead"],
        allowed=re.compile(row["allowed"], re.IGNORECASE) if row["allowed"] else None,
        folder=re.compile(row["folder"]) if row["folder"] else None,
        example=row["example"],
    )


def _relative(path: Path) -> Path:
    return path.relative_to(ROOT) if path.is_relative_to(ROOT) else path


def _is_prose(value: object) -> bool:
    return isinstance(value, str) and value.count(" ") >= _LEAST_SPACES


def _split(name: str) -> str:
    return " ".join(_WORDS_OF_NAME.findall(name))


def main(arguments: list[str]) -> int:
    """Print the figures and return 1 if a rule is broken."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("paths", nargs="*", type=Path, default=[ROOT / name for name in SOURCES], metavar="PATH")
    parser.add_argument("--where", action="store_true", help='print every passage that contains "where"')
    options = parser.parse_args(arguments)
    sources = read_sources(options.paths)
    if options.where:
        passages = [passage for source in sources for passage in source.prose]
        sys.stdout.writelines(f"{passage}\n" for passage in passages if passage.count("where"))
    banned, count = find_banned(sources), count_words(sources)
    sys.stdout.writelines(f"{line}\n" for line in banned)
    sys.stdout.write(f"if {count['if']}, where {count['where']}, banned {len(banned)}\n")
    return int(bool(banned) or count["if"] < LEAST_RATIO * count["where"])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
