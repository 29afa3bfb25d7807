"""Edits whose responses are lost on the way are sent again, are made once, and are never said not to be saved."""

import pytest
from playwright.sync_api import Route

from helpers.browser.edits import EditedJob, wait_for_revision
from helpers.browser.meshes import small_burr
from helpers.browser.visit import Visit
from helpers.installation import Installation

PROXY = "<html><h1>502 Bad Gateway</h1></html>"


@pytest.fixture
def edited(installation: Installation) -> EditedJob:
    return EditedJob(installation.url, "burr.ply", small_burr())


def lock(visit: Visit, place: int) -> None:
    visit.row(visit.parts()[place]).click()
    visit.page.click("#part-lock")


def locked(edited: EditedJob) -> list[int]:
    return [number for number, part in enumerate(edited.parts()) if part["locked"]]


@pytest.mark.parametrize("lost", ["connection", "proxy"])
def test_an_edit_whose_response_is_lost_is_sent_again_and_made_once(visit: Visit, edited: EditedJob, lost: str) -> None:
    keys: list[str | None] = []

    def lose_the_first_two(route: Route) -> None:
        keys.append(route.request.header_value("Idempotency-Key"))
        answer = route.fetch()
        if len(keys) > 2:
            route.fulfill(response=answer)
        elif lost == "connection":
            route.abort("connectionreset")
        else:
            route.fulfill(status=502, body=PROXY, content_type="text/html")

    visit.open_job(edited.id)
    visit.page.route("**/edits", lose_the_first_two)
    lock(visit, 2)
    wait_for_revision(visit, 1)
    assert keys[0] is not None
    assert keys == [keys[0]] * 3
    assert visit.page.locator(".toast").count() == 0
    assert edited.get("/revisions/latest").json()["number"] == 1
    assert locked(edited) == [2]
    lock(visit, 3)
    wait_for_revision(visit, 2)
    assert keys[3] != keys[0]
    assert locked(edited) == [2, 3]
    visit.forgive("ERR_CONNECTION_RESET", "502")


def test_an_edit_that_is_never_answered_is_not_said_to_be_unsaved(visit: Visit, edited: EditedJob) -> None:
    def lose(route: Route) -> None:
        route.fetch()
        route.fulfill(status=200, body="<html>Sign in</html>", content_type="text/html")

    visit.open_job(edited.id)
    visit.page.route("**/edits", lose)
    lock(visit, 2)
    note = visit.page.locator(".toast", has_text="It is not known whether the change was saved.")
    note.wait_for(timeout=30_000)
    assert locked(edited) == [2]
    visit.page.unroute_all()
    lock(visit, 3)
    visit.page.wait_for_selector("#conflict[open]")  # the edit was made after all
    visit.page.click("#conflict [value=repeat]")
    wait_for_revision(visit, 2)
    assert locked(edited) == [2, 3]
    visit.forgive("409")


def test_a_server_without_a_connection_is_said_to_be_unreachable(visit: Visit, edited: EditedJob) -> None:
    visit.open_job(edited.id)
    visit.page.context.set_offline(True)
    lock(visit, 2)
    visit.page.locator(".toast", has_text="The server cannot be reached.").wait_for(timeout=30_000)
    visit.page.context.set_offline(False)
    lock(visit, 3)
    wait_for_revision(visit, 1)
    assert locked(edited) == [3]
    visit.forgive("ERR_INTERNET_DISCONNECTED")
