"""The API reference at /docs."""

import re
from html.parser import HTMLParser

import httpx
import pytest


class Page(HTMLParser):
    """The texts outside of code, the anchors, and the links of a page."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.prose: list[str] = []
        self.anchors: list[str] = []
        self.links: list[str] = []
        self._in_code = False
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._in_code = tag == "code"
        self.anchors += [value for name, value in attrs if name == "id" and value]
        self.links += [value for name, value in attrs if name == "href" and value]

    def handle_endtag(self, tag: str) -> None:
        self._in_code = self._in_code and tag != "code"

    def handle_data(self, data: str) -> None:
        if not self._in_code:
            self.prose.append(data)


@pytest.fixture
def html(client: httpx.Client) -> str:
    return client.get("/docs").text


def test_the_reference_loads_nothing_from_other_servers(client: httpx.Client) -> None:
    page = client.get("/docs")
    assert page.headers["Content-Type"].startswith("text/html")
    assert "default-src 'self'" in page.headers["Content-Security-Policy"]
    assert "<script" not in page.text
    addresses = [address for address in re.findall(r'(?:src|href)="([^"]*)"', page.text) if address[0] != "#"]
    assert set(addresses) == {"docs.css", "openapi.json", "viewer/icon.svg"}
    for address in addresses:
        assert client.get(address).status_code == 200


def test_no_marks_of_markdown_are_shown(html: str) -> None:
    assert [text for text in Page(html).prose if re.search(r"`|\*\w|\]\(|\|--", text)] == []
    assert "<em>i</em>-th triangle" in html


def test_the_contents_and_all_links_lead_to_a_heading(client: httpx.Client, html: str) -> None:
    page = Page(html)
    assert len(set(page.anchors)) == len(page.anchors)
    assert {link[1:] for link in page.links if link[0] == "#"} <= set(page.anchors)
    contents = html[: html.index("<main>")]
    document = client.get("/openapi.json").json()
    operations = [f"{method.upper()} {path}" for path, methods in document["paths"].items() for method in methods]
    for title in (*operations, "Documents", "Errors", "JobDocument"):
        assert f">{title}</a>" in contents


def test_the_fields_of_bodies_are_listed(html: str) -> None:
    jobs = html[html.index('id="jobdocument"') :]
    jobs = jobs[: jobs.index("<h3")]
    for field in ("queue_position", "finished_at", "links"):
        assert f"<td><code>{field}</code></td>" in jobs
    assert jobs.count("<code>error</code>") == 2  # null or an error, and never null if the job has failed
    assert '<a href="#submittedjobdocument">' in html
    assert "idempotency_key_reused" in html
