"""CONTRIBUTING.md leads from a change to its files, and names every folder."""

import re
from pathlib import Path

import pytest

from helpers.documents import ROOT, read

TEXT = read(Path("CONTRIBUTING.md"))
PACKAGES = ("cleave", "segcore", "service", "worker")
# Typical changes: a word of each, which stands in one row of the table alone.
CHANGES = (
    "affinity",
    "input format",
    "segment may be split",
    "job document",
    "tried again",
    "output format",
    "upload limit",
    "access log",
    "request heads",
    "back-off",
    "GLB is read",
    "borders",
    "deleted job",
    "cleave list",
    "thumbnails",
)


def rows(heading: str) -> list[list[str]]:
    """Return the cells of the table below a heading."""
    section = TEXT.partition(f"{heading}\n")[2]
    table = re.search(r"(?:^\|.*\|\n)+", section, re.MULTILINE)
    assert table
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table[0].splitlines()[2:]]


def paths(cell: str) -> list[str]:
    return re.findall(r"`([\w./-]+)`", cell)


@pytest.mark.parametrize("change", CHANGES)
def test_a_typical_change_leads_to_one_file(change: str) -> None:
    ((_, first, others),) = [row for row in rows("### To change ... look in ...") if change in row[0]]
    (file,) = paths(first)
    assert (ROOT / file).is_file()
    assert all((ROOT / path).exists() for path in paths(others))


def test_every_folder_of_the_packages_is_described() -> None:
    described = {path for cell, _ in rows("## Where things are") for path in paths(cell)}
    assert all((ROOT / path).is_dir() for path in described)
    folders = {f"{path.parent.relative_to(ROOT)}/" for name in PACKAGES for path in (ROOT / name).glob("*/__init__.py")}
    assert {folder for folder in folders if not folder.startswith("cleave/")} <= described
