"""Labelling of many models with the same classes: keys, files of labels, and the way from one model to the next."""

from collections.abc import Callable

import numpy as np
import pytest

from helpers.browser.edits import EditedJob, wait_for_revision
from helpers.browser.meshes import small_burr
from helpers.browser.visit import Visit
from helpers.installation import Installation


@pytest.fixture
def new_job(installation: Installation) -> Callable[[], EditedJob]:
    return lambda: EditedJob(installation.url, "label me.ply", small_burr())


def test_classes_are_given_by_keys_and_labels_are_exported_and_imported(
    visit: Visit, new_job: Callable[[], EditedJob]
) -> None:
    edited = new_job()
    visit.open_job(edited.id)
    visit.page.click("#open-labels")
    visit.page.set_input_files(
        "#import-classes", {"name": "classes.txt", "mimeType": "text/plain", "buffer": b"arm\nball\n"}
    )
    visit.page.wait_for_function("() => document.getElementById('class-list').value === 'arm\\nball'")
    visit.page.keyboard.press("Escape")
    visit.row(visit.parts()[0]).click()
    visit.page.focus("#viewer")
    visit.page.keyboard.press("2")
    wait_for_revision(visit, 1)
    visit.row(visit.parts()[3]).click()
    visit.page.select_option("#part-class", "arm")
    wait_for_revision(visit, 2)
    assert [(part["name"], part["class"]) for part in edited.parts()[:4]] == [
        ("ball", "ball"),
        ("", ""),
        ("", ""),
        ("arm", "arm"),
    ]
    visit.page.click("#open-labels")
    with visit.page.expect_download() as saved:
        visit.page.click("#export-seg")
    numbers = np.array(saved.value.path().read_text().split(), dtype=int)
    labels = edited.labels()
    assert set(numbers[labels == 0]) == {2}
    assert set(numbers[labels == 3]) == {1}
    assert set(numbers[(labels != 0) & (labels != 3)]) == {0}
    predicted = np.arange(len(labels)) % 3
    content = "\n".join(map(str, predicted)).encode()
    visit.page.set_input_files("#import-labels", {"name": "predicted.seg", "mimeType": "text/plain", "buffer": content})
    wait_for_revision(visit, 3)
    assert (edited.labels() == predicted).all()
    assert len(visit.parts()) == 3


def test_models_are_labelled_one_after_the_other(visit: Visit, new_job: Callable[[], EditedJob]) -> None:
    edited, other = new_job(), new_job()
    edited.post("/edits", [{"op": "merge", "parts": [0, 1]}]).raise_for_status()
    jobs = {edited.id, other.id}
    visit.open()
    visit.page.click("#open-jobs")
    visit.page.wait_for_selector(".job-row")
    visit.page.fill("#job-search", "label me")
    visit.page.click("#label-jobs")
    visit.wait_for_parts()
    first = visit.address("job=")["job"]
    assert first in visit.page.evaluate("() => localStorage.getItem('cleave.batch')")
    visit.page.select_option("#batch-state", "done")
    visit.page.click("#batch-after")
    visit.page.wait_for_function("(job) => !location.hash.includes(job)", arg=first)
    visit.page.wait_for_function("() => document.getElementById('batch-open').textContent.startsWith('2 of ')")
    assert visit.page.input_value("#batch-state") == "todo"
    visit.page.click("#batch-open")
    assert "1 done" in visit.page.inner_text("#batch-summary")
    listed = visit.page.eval_on_selector_all("#batch-models button", "(all) => all.map((one) => one.dataset.job)")
    assert jobs <= set(listed)
    visit.page.click(f"#batch-models [data-job='{first}']")
    visit.page.wait_for_function("() => document.getElementById('batch-open').textContent.startsWith('1 of ')")
    assert visit.page.input_value("#batch-state") == "done"
    visit.page.click("#open-jobs")
    row = visit.page.locator(f".job-row[data-id='{edited.id}']")
    row.wait_for()
    assert "Edited" in row.inner_text()
    row.locator(".job").click()
    wait_for_revision(visit, 1)
    assert len(visit.parts()) == 6
