"""Jobs on the page: submitted, followed, listed, repeated and deleted."""

from pathlib import Path

import httpx

from cleave.settings import Settings
from helpers.browser.meshes import small_burr
from helpers.browser.visit import Visit
from helpers.files.samples import OFF, TWO_SQUARES
from helpers.installation import Installation
from helpers.jobs import accepted
from worker.jobs.store.opening import open_store
from worker.process.perform import perform


def run_beside(visit: Visit, most: int) -> None:
    """Run the shown mesh again with the dialog of parameters, with a limit of segments, and compare."""
    visit.page.fill("#parameter-max_segments", str(most))
    visit.page.click("text=Run and compare")
    visit.page.wait_for_function("(most) => document.querySelector('#beside-level').max === most", arg=str(most))


def test_a_dropped_mesh_is_submitted_followed_and_shown(visit: Visit, installation: Installation) -> None:
    visit.open()
    seen = visit.page.evaluate_handle(
        """() => {
          const seen = new Set();
          const watch = () => {
            document.querySelectorAll('#stages [data-state=now]').forEach((item) => seen.add(item.dataset.stage));
          };
          new MutationObserver(watch).observe(document.getElementById('stages'),
            { subtree: true, childList: true, attributes: true });
          return seen;
        }"""
    )
    visit.drop("dropped.ply", small_burr() + b" ")
    visit.wait_for_parts()
    stages = visit.page.evaluate("(seen) => [...seen]", seen)
    assert stages[0] == "upload"
    assert stages[-1] == "show"
    assert visit.page.locator("#title").inner_text() == "dropped.ply"
    assert visit.page.locator("#level-number").inner_text() == "7"
    assert len(visit.rows()) == 7
    job = visit.address("job=")["job"]
    assert installation.status(f"/v1/jobs/{job}") == "succeeded"
    events = [url for url in visit.requests if url.endswith("/events")]
    assert len(events) == 1
    label = visit.viewer("v.shadowRoot.querySelector('canvas').getAttribute('aria-label')")
    assert label.startswith("dropped.ply: 7 parts. ")


def test_every_stage_that_a_worker_reports_is_shown(visit: Visit, tmp_path: Path) -> None:
    reported: list[str] = []
    settings = Settings(data_dir=tmp_path)
    store = open_store(settings)
    perform(store, settings, accepted(store, small_burr()).id, lambda stage, _: reported.append(stage))
    visit.open()
    visit.drop("staged.ply", small_burr())
    visit.page.wait_for_selector("#stages [data-stage]", state="attached")
    shown = visit.page.evaluate("[...document.querySelectorAll('#stages [data-stage]')].map((e) => e.dataset.stage)")
    assert shown == ["upload", "queued", *dict.fromkeys(reported), "show"]


def test_a_sample_is_segmented(visit: Visit) -> None:
    visit.open()
    visit.page.click("[data-sample=dumbbell]")
    visit.wait_for_parts()
    assert visit.page.locator("#title").inner_text() == "dumbbell.ply"
    assert len(visit.rows()) == 3


def test_a_job_is_listed_with_its_picture_until_it_is_deleted(visit: Visit, installation: Installation) -> None:
    submitted = httpx.post(
        f"{installation.url}/v1/jobs", files={"mesh": ("to-delete.ply", small_burr() + b"\n")}, timeout=60
    ).json()
    visit.open(f"#job={submitted['id']}")
    visit.wait_for_parts()
    visit.page.reload()
    visit.wait_for_parts()
    visit.page.click("#open-jobs")
    visit.page.fill("#job-search", "TO-DEL")
    row = visit.page.locator(f".job-row[data-id='{submitted['id']}']")
    assert visit.page.inner_text("#jobs-owner") == "Everybody who can open this page sees these jobs."
    row.locator("img[src^=blob]").wait_for()
    assert visit.page.evaluate("(id) => document.querySelector(`[data-job='${id}']`).naturalWidth", submitted["id"]) > 0
    assert visit.page.locator(".job-row:visible").count() == 1
    row.get_by_role("button", name="Delete to-delete.ply").click()
    row.get_by_role("button", name="Keep").click()
    row.get_by_role("button", name="Delete to-delete.ply").click()
    row.get_by_role("button", name="Delete", exact=True).click()
    row.wait_for(state="detached")
    assert installation.get(f"/v1/jobs/{submitted['id']}").status_code in (404, 410)
    visit.page.keyboard.press("Escape")
    visit.page.wait_for_selector("#start:not([hidden])")


def test_a_mesh_can_be_segmented_again_with_other_parameters_and_compared(visit: Visit) -> None:
    visit.open()
    visit.drop("again.ply", small_burr() + b"  ")
    visit.wait_for_parts()
    visit.page.click("#open-parameters")
    visit.page.select_option("#parameter-affinity", "adjacency")
    run_beside(visit, 12)
    assert "adjacency" in visit.page.locator("#beside-about").inner_text()
    visit.viewer("(v.view = { ...v.view, azimuth: 1.25, distance: 5 })")
    view = visit.page.evaluate("document.querySelector('#beside cleave-viewer').view")
    assert (round(view["azimuth"], 6), round(view["distance"], 6)) == (1.25, 5)
    visit.set_range("beside-level", 3)
    assert visit.page.evaluate("document.querySelector('#beside cleave-viewer').parts.length") == 3
    assert len(visit.parts()) == 7
    visit.page.click("#close-beside")
    assert "beside" not in visit.address("job=") or visit.page.locator("#beside").is_hidden()
    assert len([url for url in visit.requests if url.endswith("/v1/jobs")]) == 1  # the file was sent once


def test_a_new_mesh_after_a_comparison_is_shown_alone(visit: Visit) -> None:
    visit.open()
    visit.drop("first.ply", small_burr() + b"   ")
    visit.wait_for_parts()
    visit.page.click("#open-parameters")
    run_beside(visit, 11)
    visit.drop("second.off", OFF)
    visit.page.wait_for_function("() => document.getElementById('title').textContent === 'second.off'")
    visit.settle()
    assert visit.page.locator("#beside").is_hidden()


def test_the_structure_of_a_file_is_shown_and_followed_if_asked(visit: Visit) -> None:
    visit.open()
    visit.drop("two.obj", TWO_SQUARES.encode())
    visit.wait_for_parts()
    assert visit.page.locator("#about").inner_text().endswith("2 shells · 2 groups · 1 material")
    assert "groups" not in visit.page.locator("#level-note").inner_text()
    assert visit.page.locator("#structure-choices button").all_inner_texts() == ["2 shells", "2 groups"]
    visit.page.click("[data-structure=groups]")
    visit.page.wait_for_function("() => document.querySelector('#structure-hint').hidden")
    assert len(visit.parts()) == 2
    visit.page.click("#open-parameters")
    assert visit.page.input_value("#parameter-structure") == "groups"
    visit.page.fill("#parameter-max_segments", "2")
    visit.page.click("#parameters button[value=run]")
    note = "The hierarchy ends with the 2 groups of the file"
    visit.page.wait_for_function(f"() => document.querySelector('#level-note').textContent.includes('{note}')")
    assert visit.page.get_attribute("#level", "max") == "2"
    assert len(visit.parts()) == 2
