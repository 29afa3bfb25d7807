"""The links of all documents lead to files and headings that exist."""

import re
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

from helpers.documents import ROOT, documents, read, without_code

# [text](target) and ![text](target); the text of a link may be a picture.
_LINK = re.compile(r"\]\(([^()\s]+)\)")


def anchors(text: str) -> set[str]:
    """Return the anchors that GitHub gives to the headings of a document."""
    titles = re.findall(r"^#+ +(.*)$", re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE), re.MULTILINE)
    found: set[str] = set()
    for title in titles:
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", title).lower()
        anchor = re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")
        count = sum(1 for known in found if re.fullmatch(rf"{re.escape(anchor)}(-\d+)?", known))
        found.add(f"{anchor}-{count}" if count else anchor)
    return found


def broken_links(document: Path, root: Path = ROOT) -> list[str]:
    """Return the relative links of a document that lead nowhere."""
    broken = []
    for link in _LINK.findall(without_code((root / document).read_text(encoding="utf-8"))):
        parts = urlsplit(link)
        if parts.scheme:
            continue
        target = (root / document).parent / unquote(parts.path) if parts.path else root / document
        is_inside = target.resolve().is_relative_to(root)
        has_anchor = not parts.fragment or (target.suffix == ".md" and parts.fragment in anchors(target.read_text()))
        if not (is_inside and target.exists() and has_anchor):
            broken.append(link)
    return broken


@pytest.mark.parametrize("document", documents(), ids=str)
def test_every_relative_link_leads_to_a_file_and_a_heading(document: Path) -> None:
    assert broken_links(document) == []


def test_a_link_that_leads_nowhere_is_found(tmp_path: Path) -> None:
    (tmp_path / "other.md").write_text("# Title\n\n## Twice\n\n## Twice\n", encoding="utf-8")
    (tmp_path / "page.md").write_text(
        "# The `b` of c\n\n[1](#the-b-of-c) [2](other.md#twice-1) [3](https://example.com) `[code](no.md)`\n"
        "[4](no.md) [5](#d) [6](other.md#twice-2) [7](../outside.md) [![8](no.png)](other.md)\n",
        encoding="utf-8",
    )
    assert broken_links(Path("page.md"), tmp_path) == ["no.md", "#d", "other.md#twice-2", "../outside.md", "no.png"]


def test_the_map_of_the_documentation_is_complete() -> None:
    text = read(Path("docs/README.md"))
    pages = {str(path.relative_to("docs")) for path in documents() if path.parts[0] == "docs"} - {"README.md"}
    assert pages - set(_LINK.findall(text)) == set()
