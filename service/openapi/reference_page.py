"""The API reference as an HTML page with a list of its contents."""

import re
from functools import cache
from html import escape
from itertools import pairwise

from markdown_it import MarkdownIt
from markdown_it.token import Token

_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Cleave API</title>
<meta name="viewport" content="width=device-width"><link rel="stylesheet" href="docs.css">
<link rel="icon" href="viewer/icon.svg"></head>
<body><nav id="contents" aria-label="Contents"><details open><summary>Contents</summary>{contents}</details></nav>
<main>{body}</main><a class="back" href="#contents">Contents</a></body></html>
"""


@cache
def html_page(markdown: str) -> str:
    """Return the page for the reference in Markdown; HTML in it is shown as text."""
    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    tokens = parser.parse(markdown)
    headings = _name_headings(tokens)
    return _PAGE.format(contents=_contents(headings), body=parser.renderer.render(tokens, parser.options, {}))


def _name_headings(tokens: list[Token]) -> list[tuple[int, str, str]]:
    """Give each heading the anchor that GitHub gives it; return levels, anchors and texts of those below the title."""
    headings = []
    for opening, inline in pairwise(tokens):
        if opening.type == "heading_open":
            text = inline.content.replace("`", "")
            anchor = re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-")
            opening.attrSet("id", anchor)
            headings.append((int(opening.tag[1:]), anchor, text))
    return headings[1:]


def _contents(headings: list[tuple[int, str, str]]) -> str:
    lines = (
        f'<li class="level{level}"><a href="#{anchor}">{escape(text)}</a></li>' for level, anchor, text in headings
    )
    return f"<ul>{''.join(lines)}</ul>"
