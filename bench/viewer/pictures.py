"""Takes the pictures of the viewer for docs/viewer.md."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bench.viewer.devices import DARK, DESKTOP, PHONE, new_page, save_picture
from bench.viewer.edit_pictures import take_edit_pictures
from bench.viewer.story_pictures import take_label_picture, take_print_pictures

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page


@dataclass(frozen=True, slots=True)
class Shot:
    """One picture of the page."""

    name: str  # of the file, without .png
    fragment: str = ""  # of the URL
    device: dict[str, Any] = field(default_factory=lambda: DESKTOP)  # options of the browser context
    button: str = ""  # selector of a button that is clicked first


def take_pictures(browser: Browser, url: str, large_job: str, folder: Path) -> None:
    """Write the pictures to a folder; this submits the samples to the service."""
    folder.mkdir(parents=True, exist_ok=True)
    page = new_page(browser, DESKTOP)
    jobs = {name: _sample(page, url, name) for name in ("jack", "pawn", "stool")}
    other = _rerun(page, url, jobs["pawn"], {"affinity": "concavity"})
    page.context.close()
    for shot in _shots(jobs, other, large_job):
        _take(browser, shot, f"{url}/{shot.fragment}", folder / f"{shot.name}.png")
    take_edit_pictures(browser, f"{url}/#job={jobs['stool']}", folder)
    take_print_pictures(browser, f"{url}/#job={jobs['pawn']}", folder)
    take_label_picture(browser, f"{url}/#job={jobs['stool']}", list(jobs.values()), folder)


def _shots(jobs: dict[str, str], other: str, large_job: str) -> list[Shot]:
    jack, pawn, stool = (f"#job={jobs[name]}" for name in ("jack", "pawn", "stool"))
    return [
        Shot("start"),
        Shot("desktop", pawn),
        Shot("selected", f"{pawn}&sel=3"),
        Shot("dark", f"{jack}&explode=0.8&view=0.7_1.1_3.3_0_0_0", DARK),
        Shot("thirty", f"{jack}&k=30"),
        Shot("concavity", f"{jack}&k=1&show=concavity.nolines"),
        Shot("wireframe", f"{stool}&show=wires&explode=0.5", DARK),
        Shot("compare", f"{pawn}&k=8&beside={other}"),
        Shot("difference", f"{pawn}&k=8&beside={other}", button="#beside-difference"),
        Shot("why", pawn, button="#open-why"),
        Shot("download", pawn, button="#open-download"),
        Shot("jobs", stool, DARK, "#open-jobs"),
        Shot("parameters", stool, button="#open-parameters"),
        Shot("phone", stool, PHONE),
        Shot("phone-start", device=PHONE),
        Shot("million", f"#job={large_job}"),
    ]


def _sample(page: Page, url: str, name: str) -> str:
    """Click on a sample and return the id of its job."""
    page.goto(url)
    page.click(f"[data-sample={name}]")
    page.wait_for_selector("#work:not([hidden])")
    job: str = page.evaluate("() => new URLSearchParams(location.hash.slice(1)).get('job')")
    return job


def _rerun(page: Page, url: str, job: str, parameters: dict[str, Any]) -> str:
    """Run a job again and return the id of the new one when it has ended."""
    answer = page.request.post(f"{url}/v1/jobs/{job}/rerun", data=parameters, headers={"Prefer": "wait=60"})
    return str(answer.json()["id"])


def _take(browser: Browser, shot: Shot, url: str, target: Path) -> None:
    page = new_page(browser, shot.device)
    page.goto(url)
    if shot.fragment:
        page.wait_for_selector("#work:not([hidden])")
        page.evaluate("() => document.getElementById('viewer').figures.frame()")
    if shot.button:
        page.click(shot.button)
    save_picture(page, target)
    page.context.close()
