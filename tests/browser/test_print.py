"""The dialog Print: the file that a slicer gets, and its report in words."""

import io
import zipfile
from pathlib import Path

import pytest

from browser.test_access import PHONE, violations
from helpers.browser.visit import NewVisit, Visit


def open_print(visit: Visit) -> None:
    visit.page.click("#open-download")
    visit.page.click("[data-format=print]")


def report(visit: Visit, button: str) -> str:
    visit.page.click(f"#print-form [value={button}]")
    visit.page.wait_for_selector("#print:not([aria-busy=true]) #print-report .summary")
    return visit.page.inner_text("#print-report")


def test_the_file_has_what_was_chosen_and_the_report_says_so(visit: Visit, job: str) -> None:
    visit.open_job(job)
    visit.row(visit.parts()[0]).click()
    visit.page.fill("#part-name", "Ball")
    visit.page.keyboard.press("Enter")
    open_print(visit)
    visit.page.fill("#print-size", "120")
    visit.page.fill("#print-slots", "2")
    visit.page.fill("#print-bed", "300 x 300 x 300")
    with visit.page.expect_download() as download:
        text = report(visit, "file")
    assert download.value.suggested_filename == "burr-print.3mf"
    assert all(url.endswith("&up=y") for url in visit.requests if "/print." in url)  # as the page shows it
    model = zipfile.ZipFile(io.BytesIO(Path(download.value.path()).read_bytes())).read("3D/3dmodel.model").decode()
    assert 'name="Ball"' in model
    assert model.count("<base ") == 2
    joined = model.count('name="dowel ')
    assert joined >= 4
    assert f"{7 + joined} objects in 2 filaments" in text
    assert f"{joined} of 6 contacts have a dowel." in text
    assert text.count("\nclosed, ") == 7
    assert text.count("\ndowel of ") == joined
    assert "Ball and segment " in text
    assert "The unit" not in text


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_the_report_says_why_there_is_no_connector_and_what_is_unknown(
    new_visit: NewVisit, job: str, axe: str, scheme: str
) -> None:
    visit = new_visit(color_scheme=scheme, **PHONE)
    visit.open_job(job)
    open_print(visit)
    text = report(visit, "report")
    assert "0 of 6 contacts have a dowel." in text
    assert visit.page.inner_text("#announcer") == text.splitlines()[0]
    assert text.count("no connector: the contact is small") == 6
    assert "The unit of the mesh is not known" in text
    assert violations(visit, axe) == []
    assert visit.page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_a_refused_option_is_explained(visit: Visit, job: str) -> None:
    visit.open_job(job)
    open_print(visit)
    visit.page.fill("#print-bed", "10x10x10")
    assert "bed must be three lengths of at least 50 mm" in report(visit, "report")
    visit.forgive("422")
