"""The folders of the repository: their size, and the modules that docs/algorithm.md names."""

import re
import subprocess
from collections import Counter
from pathlib import Path, PurePosixPath

import pytest

ROOT = Path(__file__).parents[2]
MOST_MODULES = 20  # in a folder, without __init__; scikit-network has at most 11
ALGORITHM = ROOT / "docs" / "algorithm.md"
_BRACES = re.compile(r"([\w/.]*)\{([^{}]*)\}([\w/.]*)")


def tracked_modules() -> list[PurePosixPath]:
    listed = subprocess.run(["git", "ls-files", "*.py"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [PurePosixPath(line) for line in listed.splitlines() if (ROOT / line).exists()]


def crowded(modules: list[PurePosixPath]) -> dict[str, int]:
    """Return the folders with too many modules, and their number.

    A folder of commands has a module for each command, which is found by its name, however many there are.
    """
    counted = [module for module in modules if module.name != "__init__.py" and module.parent.name != "commands"]
    count = Counter(str(module.parent) for module in counted)
    return {folder: number for folder, number in count.items() if number > MOST_MODULES}


def names_of(module: PurePosixPath, others: list[PurePosixPath]) -> set[str]:
    """Return the names by which a document may refer to a module of segcore, with or without .py.

    These are the path in segcore with slashes or dots, and the file name if it is the only one.
    """
    path = module.relative_to("segcore").with_suffix("")
    names = {str(path), str(path).replace("/", "."), f"segcore/{path}", f"segcore.{str(path).replace('/', '.')}"}
    if sum(other.name == module.name for other in others) == 1:
        names.add(path.name)
    return {name for known in names for name in (known, f"{known}.py")}


def quoted(text: str) -> set[str]:
    """Return the words in code font; `a/{b, c}.py` stands for `a/b.py` and `a/c.py`."""
    words: set[str] = set()
    for code in re.findall(r"`([^`\n]+)`", text):
        for before, inside, after in _BRACES.findall(code):
            words |= {f"{before}{part.strip()}{after}" for part in inside.split(",")}
        words |= set(re.findall(r"[\w/.]+", code))
    return words


def unnamed(modules: list[PurePosixPath], text: str) -> list[str]:
    """Return the modules that a text does not name."""
    words = quoted(text)
    return [str(module) for module in modules if not names_of(module, modules) & words]


def test_no_folder_has_more_than_twenty_modules() -> None:
    assert crowded(tracked_modules()) == {}


def test_every_module_of_segcore_is_named_in_the_description_of_the_algorithm() -> None:
    modules = [path for path in tracked_modules() if path.parts[0] == "segcore" and path.name != "__init__.py"]
    assert len(modules) > MOST_MODULES
    assert unnamed(modules, ALGORITHM.read_text(encoding="utf-8")) == []


def test_a_folder_with_one_module_too_many_is_found() -> None:
    modules = [PurePosixPath("a", f"m{number}.py") for number in range(MOST_MODULES)]
    assert crowded([*modules, PurePosixPath("a/__init__.py"), PurePosixPath("a/b/m.py")]) == {}
    assert crowded([*modules, PurePosixPath("a/more.py")]) == {"a": MOST_MODULES + 1}


@pytest.mark.parametrize(
    ("text", "missing"),
    [
        ("`cut/rules.py`, `io/gltf/reader`, `io.obj.reader`", []),
        ("`rules.py`, `io/{gltf, obj}/reader.py`", []),
        ("`segcore/cut/rules.py` and `segcore.io.gltf.reader`", ["segcore/io/obj/reader.py"]),
        (
            "cut/rules.py, `reader.py`",
            ["segcore/cut/rules.py", "segcore/io/gltf/reader.py", "segcore/io/obj/reader.py"],
        ),
    ],
)
def test_a_module_may_be_named_by_its_path_or_a_unique_file_name(text: str, missing: list[str]) -> None:
    modules = [PurePosixPath("segcore", path) for path in ("cut/rules.py", "io/gltf/reader.py", "io/obj/reader.py")]
    assert unnamed(modules, text) == missing
