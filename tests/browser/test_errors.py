"""Errors are explained with a remedy, and the page waits for a server that is away."""

import os
import signal

import pytest
from playwright.sync_api import Route

from helpers.browser.meshes import small_burr
from helpers.browser.visit import MAX_UPLOAD_BYTES, Visit
from helpers.files.written import mesh_bytes
from helpers.installation import Installation
from helpers.waiting import wait_until
from segcore.shapes import burr


def problem(visit: Visit) -> tuple[str, str, str]:
    """Return the code and the text of the error, and the label of its button."""
    visit.page.wait_for_selector("#problem:not([hidden])")
    code = visit.page.get_attribute("#problem", "data-code") or ""
    return code, visit.page.inner_text("#problem"), visit.page.inner_text("#remedy")


def test_a_truncated_file_is_explained_and_another_can_be_chosen(visit: Visit) -> None:
    visit.open()
    visit.drop("half.ply", small_burr()[:60_000])
    code, text, button = problem(visit)
    assert code == "invalid_mesh"
    assert "Export it again" in text
    assert button == "Choose another file"
    with visit.page.expect_file_chooser() as chooser:
        visit.page.click("#remedy")
    chooser.value.set_files([{"name": "whole.ply", "mimeType": "model/ply", "buffer": small_burr() + b"   "}])
    visit.wait_for_parts()


def test_a_file_that_is_too_large_is_refused_before_it_is_sent(visit: Visit) -> None:
    visit.open()
    visit.page.wait_for_function("() => document.getElementById('formats').textContent.includes('up to')")
    visit.drop("huge.stl", b"\0" * (MAX_UPLOAD_BYTES + 1))
    code, text, _ = problem(visit)
    assert code == "too_large"
    assert "1.91 MB" in text
    assert not [url for url in visit.requests if url.endswith("/v1/jobs")]


@pytest.mark.parametrize(
    ("status", "expected", "sentence"),
    [
        (200, "unexpected", "Cleave itself does not"),
        (413, "too_large", "client_max_body_size"),
        (502, "unexpected", "Cleave itself does not"),
    ],
)
def test_what_a_proxy_answers_is_explained(visit: Visit, status: int, expected: str, sentence: str) -> None:
    visit.open()
    visit.page.route("**/v1/jobs", lambda route: route.fulfill(status=status, body="<html>nginx</html>"))
    visit.drop("any.ply", small_burr() + b" ")
    code, text, _ = problem(visit)
    assert code == expected
    assert sentence in text
    visit.forgive(str(status))


def test_going_back_from_an_error_returns_to_the_previous_result(visit: Visit, job: str) -> None:
    visit.open_job(job)
    visit.drop("document.pdf", b"%PDF-1.7 and so on, too")
    problem(visit)
    assert visit.page.locator("#work").is_hidden()
    visit.page.click("#back")
    assert visit.page.locator("#work").is_visible()
    assert len(visit.parts()) == 7


@pytest.mark.parametrize(
    ("name", "codes"), [("document.pdf", {"no_mesh"}), ("document.stl", {"invalid_mesh", "unsupported_format"})]
)
def test_a_file_of_another_kind_is_explained(visit: Visit, name: str, codes: set[str]) -> None:
    visit.open()
    visit.drop(name, b"%PDF-1.7 and so on")
    code, text, _ = problem(visit)
    assert code in codes
    assert text.count(".") >= 2


def test_the_page_waits_for_a_server_that_is_unreachable_during_a_job(visit: Visit) -> None:
    def refuse(route: Route) -> None:
        route.abort("connectionrefused")

    visit.open()
    visit.page.route("**/v1/jobs/*", refuse)
    visit.page.route("**/v1/jobs/*/events", refuse)
    visit.drop("waiting.ply", small_burr() + b"    ")
    visit.page.wait_for_selector("#offline:not([hidden])")
    visit.page.unroute_all()
    visit.wait_for_parts()
    assert visit.page.locator("#offline").is_hidden()
    visit.forgive("ERR_CONNECTION_REFUSED")


def test_the_page_waits_until_a_killed_service_is_restarted(visit: Visit, installation: Installation) -> None:
    visit.open()
    (worker,) = installation.children("worker.process small")
    os.kill(worker, signal.SIGSTOP)  # so that the job does not end before the service is killed
    try:
        visit.drop("survivor.ply", small_burr() + b"       ")
        visit.address("job=")  # the whole response to the upload has arrived
        (service,) = installation.children("service.host.http_server")
        os.kill(service, signal.SIGKILL)
        wait_until(lambda: installation.children("service.host.http_server") not in ([service], []))
    finally:
        os.kill(worker, signal.SIGCONT)
    visit.wait_for_parts()
    assert visit.page.locator("#offline").is_hidden()
    assert len(visit.parts()) == 7
    visit.forgive("net::ERR")


def test_an_upload_without_a_server_can_be_retried(visit: Visit) -> None:
    visit.open()
    visit.page.wait_for_function("() => document.getElementById('formats').textContent.includes('up to')")
    visit.page.context.set_offline(True)
    visit.drop("again.ply", small_burr() + b"     ")
    code, _, button = problem(visit)
    assert (code, button) == ("unreachable", "Try again")
    visit.page.context.set_offline(False)
    visit.page.click("#remedy")
    visit.wait_for_parts()
    visit.forgive("ERR_INTERNET_DISCONNECTED")


def test_an_upload_whose_response_is_lost_can_be_retried_without_a_second_job(
    visit: Visit, installation: Installation
) -> None:
    taken: list[str] = []

    def lose(route: Route) -> None:
        taken.append(route.fetch().json()["id"])
        route.abort("connectionreset")

    visit.open()
    visit.page.route("**/v1/jobs", lose)
    visit.drop("lost-response.ply", small_burr() + b"          ")
    code, _, button = problem(visit)
    assert (code, button) == ("unreachable", "Try again")
    visit.page.unroute_all()
    visit.page.click("#remedy")
    visit.wait_for_parts()
    jobs = installation.get("/v1/jobs").json()["jobs"]
    assert [job["id"] for job in jobs if job["input"]["file_name"] == "lost-response.ply"] == taken
    visit.forgive("ERR_CONNECTION_RESET")


def compare(visit: Visit, most: str) -> None:
    """Ask for another result of the shown mesh, with a limit of segments."""
    visit.page.click("#open-parameters")
    visit.page.fill("#parameter-max_segments", most)
    visit.page.click("text=Run and compare")


def test_a_rerun_whose_response_is_lost_makes_no_second_job(visit: Visit, job: str) -> None:
    """A request is sent again with its key; the next one, after a response, has another."""
    keys: list[str | None] = []

    def lose_the_first(route: Route) -> None:
        keys.append(route.request.header_value("Idempotency-Key"))
        answer = route.fetch()
        if len(keys) == 1:
            route.abort("connectionreset")
        else:
            route.fulfill(response=answer)

    visit.open_job(job)
    visit.page.route("**/rerun", lose_the_first)
    compare(visit, "30")
    assert problem(visit)[0] == "unreachable"
    visit.page.click("#remedy")
    visit.page.wait_for_function("() => document.querySelector('#beside-level').max === '30'")
    compare(visit, "31")
    visit.page.wait_for_function("() => document.querySelector('#beside-level').max === '31'")
    assert None not in keys
    assert keys[0] == keys[1] != keys[2]
    visit.forgive("ERR_CONNECTION_RESET")


@pytest.mark.parametrize("fragment", ["#job=" + "0" * 32, "#job=../../x"])
def test_a_link_to_an_unknown_job_leads_to_the_start_page(visit: Visit, fragment: str) -> None:
    visit.open(fragment)
    code, _, button = problem(visit)
    assert code in ("job_not_found", "not_found")
    assert button == "Choose another file"
    visit.page.click("#back")
    visit.page.wait_for_selector("#start:not([hidden])")
    visit.forgive("404")


def test_a_running_job_can_be_stopped(visit: Visit, installation: Installation) -> None:
    held: list[Route] = []  # requests that get no response
    visit.open()
    visit.page.route("**/v1/jobs/*/events", lambda route: held.append(route))
    with visit.page.expect_response("**/v1/jobs") as submitted:
        visit.drop("stopped.ply", mesh_bytes(burr(5).mesh, "ply") + b"      ")  # four times the usual work
    visit.page.click("#stop")
    visit.page.wait_for_selector("#start:not([hidden])")
    job = installation.get(f"/v1/jobs/{submitted.value.json()['id']}").json()
    assert job["status"] in ("canceled", "succeeded")  # succeeded if it had ended before it was stopped
    for route in held:
        route.abort()


def test_an_error_of_a_download_is_shown_above_the_dialog(visit: Visit, job: str) -> None:
    detail = {"code": "job_deleted", "detail": "The job was deleted.", "status": 410}
    visit.open_job(job)
    visit.page.click("#open-download")
    visit.page.route("**/model.glb?segments=*", lambda route: route.fulfill(status=410, json=detail))
    visit.page.click("[data-format=glb]")
    note = visit.page.locator(".toast", has_text="This job was deleted")
    note.wait_for()
    x, y = note.evaluate("(e) => [e.getBoundingClientRect().x + 8, e.getBoundingClientRect().y + 8]")
    assert visit.page.evaluate("([x, y]) => document.elementsFromPoint(x, y)[0].closest('dialog')?.id", [x, y])
    assert visit.page.locator("#download #announcer").inner_text() == note.inner_text()
    visit.page.keyboard.press("Escape")
    visit.page.locator("body > #announcer").wait_for(state="attached")
    visit.forgive("410")


def test_a_browser_without_webgl_is_told_so(visit: Visit, job: str) -> None:
    visit.page.add_init_script(
        """const get = HTMLCanvasElement.prototype.getContext;
        HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
          return kind.startsWith('webgl') ? null : get.call(this, kind, ...more);
        };"""
    )
    visit.open(f"#job={job}")
    code, text, _ = problem(visit)
    assert code == "no_webgl"
    assert "WebGL 2" in text
    visit.forgive("WebGL")


def test_a_job_that_is_computed_is_found_again_by_a_reload(visit: Visit, installation: Installation) -> None:
    visit.open()
    (worker,) = installation.children("worker.process small")
    os.kill(worker, signal.SIGSTOP)  # so that the job does not end before the reload
    try:
        visit.drop("reloaded.ply", small_burr() + b"        ")
        visit.address("job=")
        visit.page.reload()
        visit.page.wait_for_selector("#progress:not([hidden])")
        assert visit.page.inner_text("#progress-name") == "reloaded.ply"
    finally:
        os.kill(worker, signal.SIGCONT)
    visit.wait_for_parts()
    assert visit.page.inner_text("#title") == "reloaded.ply"
    visit.forgive("net::ERR")


def test_the_page_says_why_a_job_waits_and_what_runs(visit: Visit) -> None:
    """The kernels are compiled before the first worker is ready."""
    held: list[Route] = []
    missing = {"ready": False, "queue": True, "store": True, "workers": 0, "missing": ["No worker is ready."]}
    visit.open()
    visit.page.route("**/v1/jobs/*/events", lambda route: held.append(route))
    visit.page.route("**/readyz", lambda route: route.fulfill(status=503, json=missing))
    visit.page.route("**/v1/jobs", lambda route: waiting(route))
    visit.drop("first.ply", small_burr() + b"         ")
    visit.page.wait_for_selector("#progress-wait:has-text('compiles the numerical kernels')")
    now = visit.page.locator("#stages [data-state=now]")
    assert now.get_attribute("data-stage") == "queued"
    assert now.locator(".icon").evaluate("(e) => getComputedStyle(e).opacity") == "0"
    assert visit.page.locator("#stages [data-stage=upload] .icon").evaluate("(e) => getComputedStyle(e).opacity") == "1"
    with visit.page.expect_response("**/cancel"):
        visit.page.click("#stop")
    visit.page.wait_for_selector("#start:not([hidden])")
    for route in held:
        route.abort()
    visit.forgive("503", "409", "net::ERR")  # 409 if the job had ended before it was stopped


def waiting(route: Route) -> None:
    """Answer a submission as if its job was waiting."""
    answer = route.fetch()
    route.fulfill(status=202, json=answer.json() | {"status": "queued", "finished_at": None})
