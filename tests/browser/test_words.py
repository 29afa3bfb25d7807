"""The page says in words what the automatic number, the curve and the parameters are."""

from helpers.browser.visit import Visit
from segcore.parameters import parameters_schema


def test_the_automatic_number_and_the_curve_are_explained(visit: Visit, job: str) -> None:
    visit.open_job(job)
    assert visit.page.inner_text("#level-note") == "The next cut has a less clear border."
    visit.page.click("#open-why")
    assert visit.page.inner_text("#why-title") == "Why 7 parts?"
    text = visit.page.inner_text("#why-text")
    values = visit.viewer("v.tree.cutValues.slice(0, 7)")
    assert f"have values of at most {max(values[:6]):.3g}" in text
    assert f"the next one would have {values[6]:.3g}" in text
    assert "from many meshes that people have cut by hand" in text
    assert "The curve above the slider shows the value of each cut" in text


def test_parameters_speak_plainly_and_name_algorithms_only_behind_advanced(visit: Visit) -> None:
    schema = parameters_schema()["properties"]
    visit.open()
    visit.page.click("#open-parameters")
    visit.page.locator("#parameter-affinity").wait_for()
    plain = visit.page.inner_text("#usual-parameters")
    assert schema["affinity"]["title"] in plain
    choices = visit.page.locator("#parameter-affinity option").all_inner_texts()
    assert choices == list(schema["affinity"]["x-choices"].values())
    assert visit.page.locator("#parameter-solver").is_hidden()
    visit.page.click("text=Advanced")
    assert visit.page.locator("#parameter-solver").is_visible()
    assert visit.page.locator("#more-parameters code").first.inner_text() == "preset"


def test_the_download_says_that_it_has_hidden_parts(visit: Visit, job: str) -> None:
    visit.open_job(job)
    visit.row(visit.parts()[2]).click()
    visit.page.click("#hide")
    visit.page.click("text=Download")
    assert visit.page.inner_text("#download-title") == "Download 7 parts"
    assert visit.page.inner_text("#download-hidden") == "1 hidden part is in the files, too."
