"""If the server requires API keys, the page asks for one, stores it, and shows only the jobs of its owner."""

from collections.abc import Iterator

import httpx
import pytest

from browser.test_access import violations
from helpers.browser.visit import NewVisit, Visit
from helpers.installation import Installation
from service.keys import key_digest

ANNA, BERTA = "cleave_anna", "cleave_berta"


class _Guarded(Installation):
    settings = Installation.settings | {
        "CLEAVE_AUTH": "required",
        "CLEAVE_API_KEYS": f"anna:{key_digest(ANNA)},berta:{key_digest(BERTA)}",
    }


@pytest.fixture(scope="module")
def installation() -> Iterator[Installation]:
    with _Guarded(workers=1) as installation:
        yield installation


def enter(visit: Visit, key: str) -> None:
    visit.page.wait_for_selector("#problem:not([hidden])[data-code=unauthorized]")
    visit.page.click("#remedy")
    visit.page.fill("#key", key)
    visit.page.keyboard.press("Enter")


def ignore_unauthorized(visit: Visit) -> None:
    """Drop the errors that the browser reports for every response of 401."""
    visit.forgive("401")


def test_a_wrong_key_is_refused_and_a_valid_one_is_stored(visit: Visit, installation: Installation) -> None:
    visit.open()
    visit.page.click("[data-sample=dumbbell]")
    enter(visit, "cleave_nobody")
    visit.page.wait_for_selector("#problem:not([hidden])[data-code=unauthorized]")
    sent = [url for url in visit.requests if url.endswith("/v1/jobs")]
    assert sent == []  # the key is asked for before the upload
    enter(visit, ANNA)
    visit.wait_for_parts()
    visit.page.reload()
    visit.wait_for_parts()
    job = visit.address("job=")["job"]
    visit.page.click("#open-jobs")
    visit.page.locator(f".job-row[data-id='{job}'] img[src^=blob]").wait_for()
    visit.page.keyboard.press("Escape")
    visit.page.click("#open-download")
    with visit.page.expect_download() as saved:
        visit.page.click("[data-format=glb]")
    assert saved.value.path().read_bytes().startswith(b"glTF")
    assert "Authorization: Bearer $CLEAVE_KEY" in visit.page.inner_text("#curl")
    assert ANNA not in visit.page.inner_text("#curl")
    assert httpx.get(f"{installation.url}/v1/jobs/{job}").status_code == 401
    visit.page.keyboard.press("Escape")
    visit.page.click("#open-jobs")
    assert "of the API key that this browser stores" in visit.page.inner_text("#jobs-owner")
    visit.page.click("#jobs-forget")
    visit.page.wait_for_selector("#key-state:has-text('This server requires an API key.')")
    assert visit.page.evaluate("localStorage.getItem('cleave.key') ?? localStorage.getItem('cleave.states')") is None
    ignore_unauthorized(visit)


def test_a_link_requires_the_key_of_the_owner_of_the_job(
    new_visit: NewVisit, installation: Installation, axe: str
) -> None:
    headers = {"Authorization": f"Bearer {ANNA}", "Prefer": "wait=60"}
    sample = httpx.get(f"{installation.url}/samples/dumbbell.ply").content
    answer = httpx.post(
        f"{installation.url}/v1/jobs", files={"mesh": ("mine.ply", sample + b" ")}, headers=headers, timeout=90
    )
    link = f"#job={answer.json()['id']}"
    owner, other = new_visit(), new_visit()
    for visit, key in ((owner, ANNA), (other, BERTA)):
        visit.open(link)
        visit.page.wait_for_selector("#problem:not([hidden])")
        visit.page.click("#remedy")
        assert violations(visit, axe) == []
        visit.page.keyboard.press("Escape")
        enter(visit, key)
    owner.wait_for_parts()
    other.page.wait_for_selector("#problem[data-code=job_not_found]")
    for visit in (owner, other):
        ignore_unauthorized(visit)
    other.forgive("404")
