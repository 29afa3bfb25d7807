"""The prose of all Python sources is plain technical English; ``python tests/house/prose.py`` prints the figures."""

from pathlib import Path

import pytest

from house.prose import (
    LEAST_RATIO,
    ROOT,
    SOURCES,
    Source,
    banned_words,
    count_words,
    find_banned,
    main,
    read_source,
    read_sources,
)


@pytest.fixture(scope="module")
def sources() -> list[Source]:
    """The Python files of the repository."""
    return read_sources(ROOT / name for name in SOURCES)


def test_conditions_begin_with_if(sources: list[Source]) -> None:
    count = count_words(sources)
    assert count["if"] >= LEAST_RATIO * count["where"]


def test_no_banned_word_is_used(sources: list[Source]) -> None:
    assert "\n".join(find_banned(sources)) == ""


@pytest.mark.parametrize("word", banned_words(), ids=lambda word: word.pattern.pattern)
def test_a_banned_word_is_found_in_prose(word, tmp_path: Path) -> None:
    for number, source in enumerate((f"# {word.example}\n", f'"""Return {word.example}."""\n')):
        path = tmp_path / "service" / f"module{number}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(source)
        (line,) = find_banned([read_source(path)])
        assert f"{path}:1:" in line
        assert word.instead in line


def test_a_banned_word_is_found_in_names(tmp_path: Path) -> None:
    for name in ("connect_impatiently", "VitalSigns", "_TALLIES", "Wish", "is_doomed", "courierOf"):
        path = tmp_path / "module.py"
        path.write_text(f"import a\n\na.{name} = 1\n")
        assert [line.partition(": ")[0] for line in find_banned([read_source(path)])] == [f"{path}:3"]


def test_allowed_phrases_other_folders_and_stored_names_are_left_out(tmp_path: Path) -> None:
    for folder, lines in (
        ("service", ['"""Lower-case letters, digits."""', "# a letter"]),
        ("segcore", ['"""The letters of a word."""', "# the seam of a texture"]),
        ("worker", ['FOLDER = "doomed"', "# doomed/<id>", "# is doomed"]),
    ):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "module.py").write_text("\n".join(lines))
    found = find_banned(read_sources([tmp_path]))
    assert [line.partition(": ")[0] for line in found] == [
        f"{tmp_path}/service/module.py:2",
        f"{tmp_path}/worker/module.py:3",
    ]


def test_words_are_counted_in_comments_docstrings_and_messages_alone(tmp_path: Path) -> None:
    path = tmp_path / "module.py"
    path.write_text(
        '"""None if it is undefined."""\nx = 1 if True else "where"  # Where the\nm = f"{x} is there if, if"\n'
    )
    assert count_words(read_sources([tmp_path])) == {"if": 3, "where": 1}


def test_the_exit_status_is_1_if_a_rule_is_broken(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "module.py"
    path.write_text("# None if it is undefined\n")
    assert main([str(path)]) == 0
    assert capsys.readouterr().out == "if 1, where 0, banned 0\n"
    path.write_text("# None where it is undefined\n")
    assert main(["--where", str(path)]) == 1
    assert capsys.readouterr().out == f"{path}:1: # None where it is undefined\nif 0, where 1, banned 0\n"
