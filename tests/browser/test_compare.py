"""Two results of one file: matched colours, linked sides, and the difference as a figure and as a picture."""

import io
from typing import Any

import httpx
import numpy as np
import pytest

import segcore
from helpers.browser.meshes import small_burr
from helpers.browser.visit import Visit
from helpers.installation import Installation
from helpers.waiting import wait_until

WAIT = {"Prefer": "wait=60"}


@pytest.fixture(scope="module")
def other_job(installation: Installation, job: str) -> str:
    """The job of the same mesh with other parameters."""
    parameters = {"affinity": "adjacency", "max_segments": 20}
    answer = httpx.post(f"{installation.url}/v1/jobs/{job}/rerun", json=parameters, timeout=60)
    path = f"/v1/jobs/{answer.json()['id']}"
    wait_until(lambda: installation.status(path) == "succeeded")
    return str(answer.json()["id"])


def compare(visit: Visit, job: str, other: str, segments: int) -> None:
    visit.open_job(job, f"&beside={other}")
    visit.page.wait_for_selector("#beside-difference:not([hidden])")
    visit.set_range("beside-level", segments)
    visit.settle()


def second(visit: Visit, expression: str) -> Any:
    """Evaluate an expression of the viewer of the second result ``w`` and of the first ``v``."""
    return visit.viewer(f"((w) => {expression})(document.querySelector('#beside cleave-viewer'))")


def overlaps(installation: Installation, job: str, other: str, segments: int) -> Any:
    """The areas that the parts of both results share, by label."""
    first, then = (
        installation.get(f"/v1/jobs/{one}/labels?segments={count}").json()["labels"]
        for one, count in ((job, 7), (other, segments))
    )
    mesh = segcore.read_mesh(io.BytesIO(small_burr()), "ply")
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    table = np.zeros((7, segments))
    np.add.at(table, (first, then), np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2)
    return table / table.sum()


def test_the_difference_is_a_figure(visit: Visit, installation: Installation, job: str, other_job: str) -> None:
    compare(visit, job, other_job, 9)
    table = overlaps(installation, job, other_job, 9)
    share = 1 - sum(row.max() for a, row in enumerate(table) if table[:, row.argmax()].argmax() == a)
    rand = (table.sum(axis=0) ** 2).sum() + (table.sum(axis=1) ** 2).sum() - 2 * (table**2).sum()
    text = visit.page.inner_text("#beside-figures")
    shown = [float(word.rstrip("%")) for word in text.split() if word[0].isdigit()]
    assert abs(shown[0] - 100 * share) <= 0.051
    assert abs(shown[-1] - rand) <= 0.006 * rand


def test_parts_have_the_colour_of_the_part_that_they_overlap_most(
    visit: Visit, installation: Installation, job: str, other_job: str
) -> None:
    compare(visit, job, other_job, 9)
    matched = overlaps(installation, job, other_job, 9).argmax(axis=0).tolist()
    assert second(visit, "w.parts.map((id) => w.colorOf(id))") == second(
        visit, f"{matched}.map((label) => v.colorOf(v.parts[label]))"
    )


def test_both_sides_are_linked(visit: Visit, installation: Installation, job: str, other_job: str) -> None:
    compare(visit, job, other_job, 9)
    matched = overlaps(installation, job, other_job, 9).argmax(axis=0).tolist()
    part = 3
    visit.row(visit.parts()[part]).click()
    visit.settle()
    chosen = second(visit, "w.selected.map((id) => w.parts.indexOf(id))")
    assert sorted(chosen) == [label for label, of in enumerate(matched) if of == part]
    visit.set_range("explode", 50)
    visit.page.click("#isolate")
    visit.settle()
    assert second(visit, "w.getAttribute('explode')") == "0.5"
    left = second(visit, "w.parts.flatMap((id, label) => w.hiddenParts.has(id) ? [] : [label])")
    assert left == sorted(chosen)
    assert second(visit, "JSON.stringify(w.view) === JSON.stringify(v.view)")
    other = matched[0]
    second(
        visit,
        "w.dispatchEvent(new CustomEvent('cleave-select', { detail: { parts: [w.parts[0]] }, cancelable: true }))",
    )
    assert visit.selected() == [visit.parts()[other]]


def test_the_difference_is_a_picture(visit: Visit, job: str, other_job: str) -> None:
    compare(visit, job, other_job, 20)
    visit.page.click("#lines")
    visit.settle()

    def marked() -> int:
        return sum(color[3] == 255 and color[0] > 1.5 * max(color[1:3]) for color in visit.colors_at(visit.grid(8)))

    before = marked()
    visit.page.click("#beside-difference")
    visit.settle()
    assert marked() > before
    visit.page.click("#beside-difference")
    visit.settle()
    assert marked() == before


def test_another_file_is_shown_but_not_compared(visit: Visit, installation: Installation, job: str) -> None:
    answer = httpx.post(f"{installation.url}/v1/jobs", content=small_burr() + b"x", headers=WAIT, timeout=90)
    visit.open_job(job, f"&beside={answer.json()['id']}")
    visit.page.wait_for_selector("#beside-figures:has-text('Another file')")
    assert visit.page.locator("#beside-difference").is_hidden()
