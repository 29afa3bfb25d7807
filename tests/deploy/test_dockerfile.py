"""The parser of the Dockerfile and of .dockerignore, which `make image-check` uses."""

from pathlib import Path

import pytest

from deploy.context import is_sent, read_patterns
from deploy.dockerfile import UnknownInstruction, assignments, parse

ROOT = Path(__file__).parents[2]
EXAMPLE = """
# a comment
FROM base:1 AS build
ENV A=1 \\
    B="two words"
# in between
RUN first && \\
    second
FROM other
COPY --from=build /a /b
ENV A=$A:${B}
ENTRYPOINT ["cleave", "serve"]
"""


def test_stages_and_their_instructions_are_parsed() -> None:
    build, last = parse(EXAMPLE)
    assert (build.name, build.base, last.name, last.base) == ("build", "base:1", "1", "other")
    assert [(one.name, one.text) for one in build.instructions] == [
        ("ENV", 'A=1 B="two words"'),
        ("RUN", "first && second"),
    ]
    copy, variables, entry = last.instructions
    assert (copy.flags(), copy.arguments()) == ({"from": "build"}, ["/a", "/b"])
    assert assignments(build.instructions[0], {}) == {"A": "1", "B": "two words"}
    assert assignments(variables, {"A": "x", "B": "y"}) == {"A": "x:y"}
    assert last.last("ENTRYPOINT") is entry
    assert entry.words() == ["cleave", "serve"]


@pytest.mark.parametrize("text", ["RUN before any stage", "FROM a\nONBUILD RUN x", "FROM a\nADD http://x /y"])
def test_an_unsupported_instruction_is_an_error(text: str) -> None:
    with pytest.raises(UnknownInstruction):
        parse(text)


def test_the_last_pattern_that_matches_decides() -> None:
    patterns = ["*", "!segcore", "**/__pycache__", "!docs/a.md"]
    sent = ["segcore/mesh.py", "segcore/io/off.py", "docs/a.md"]
    kept = ["secret.txt", "segcore/__pycache__/mesh.pyc", "segcore/io/__pycache__/off.pyc", "docs/b.md", "docs"]
    assert [path for path in sent + kept if is_sent(path, patterns)] == sent


def test_the_files_that_the_dockerfile_copies_are_sent_and_secrets_are_not() -> None:
    patterns = read_patterns(ROOT / ".dockerignore")
    copies = [
        source
        for stage in parse((ROOT / "Dockerfile").read_text())
        for one in stage.instructions
        if one.name == "COPY" and "from" not in one.flags()
        for source in one.arguments()[:-1]
    ]
    assert {"cleave", "segcore", "worker", "service"} <= set(copies)
    for source in copies:
        path = ROOT / source
        file = path if path.is_file() else next(path.glob("*.py"))
        assert is_sent(str(file.relative_to(ROOT)), patterns), source
    assert not any(is_sent(path, patterns) for path in (".git/config", ".env", "tests/conftest.py", "data/key"))


def test_the_image_runs_as_its_own_user_and_contains_the_kernels_of_its_installation() -> None:
    *_, image = parse((ROOT / "Dockerfile").read_text())
    assert image.last("USER").text not in ("root", "0", "0:0")
    text = (ROOT / "Dockerfile").read_text()
    # Without -P the kernels of /src would be compiled instead of those of the installation.
    assert "python -P -m segcore.kernels" in text
