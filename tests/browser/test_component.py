"""<cleave-viewer> in another page, as docs/reference/viewer.md describes it."""

import io
import json
import struct
from pathlib import Path

from playwright.sync_api import Route

from helpers.browser.other_site import OtherSite
from helpers.browser.visit import NewVisit, Visit
from helpers.documents import blocks, read
from helpers.files.hierarchies import two_strips
from helpers.installation import Installation
from segcore.io.gltf.writer import write_glb

FRONTEND = Path("docs/how-to/frontend.md")
EXAMPLE_ID = "5f1c5d1d2c0f4e0fa8f0b4b2f1a9d6c3"
PAGE = """<!doctype html><html lang="en"><title>Another page</title>
<script type="module" src="viewer/cleave-viewer.js"></script>
<cleave-viewer src="v1/jobs/{job}/model.glb{query}" {attributes}></cleave-viewer>"""


def embed(visit: Visit, job: str, attributes: str = "", query: str = "?levels=all") -> None:
    body = PAGE.format(job=job, attributes=attributes, query=query)
    visit.page.route("**/embedding", lambda route: route.fulfill(body=body, content_type="text/html"))
    visit.open("embedding")
    visit.page.add_style_tag(content="cleave-viewer { width: 400px; height: 300px }")
    visit.page.wait_for_function("() => document.querySelector('cleave-viewer').tree !== null")


def evaluate(visit: Visit, expression: str) -> object:
    value: object = visit.page.evaluate(
        f"() => {{ const v = document.querySelector('cleave-viewer'); return {expression} }}"
    )
    return value


def test_attributes_set_what_is_shown(visit: Visit, job: str) -> None:
    embed(visit, job, 'segments="4" label="A burr"')
    assert evaluate(visit, "v.parts.length") == 4
    assert str(evaluate(visit, "v.shadowRoot.querySelector('canvas').ariaLabel")).startswith("A burr: 4 parts. ")
    assert evaluate(visit, "(v.setAttribute('segments', '9'), v.parts.length)") == 9
    assert evaluate(visit, "(v.setAttribute('selected', '1 2'), [...v.selected])") == [1, 2]


def test_a_file_of_one_level_is_shown_too(visit: Visit, job: str) -> None:
    embed(visit, job, query="?segments=5")
    assert evaluate(visit, "[v.parts.length, v.tree.maxSegments]") == [5, 5]


def test_the_tree_is_that_of_the_service_at_all_levels_and_at_one(visit: Visit, job: str) -> None:
    """Nodes inside a step are not in the file, but in the tree."""
    facts = "v.tree.nodes.map((n) => [n.id, n.parent, n.children, n.level, n.label, n.faces, n.step, n.cutValue])"
    embed(visit, job)
    whole = evaluate(visit, facts)
    nodes = visit.page.evaluate("(path) => fetch(path).then((a) => a.json())", f"v1/jobs/{job}/hierarchy")["nodes"]
    names = ("id", "parent", "children", "level", "label", "faces", "step", "cut_value")
    assert whole == [[-1 if name == "parent" and not node["id"] else node[name] for name in names] for node in nodes]
    embed(visit, job, query="?segments=5")
    part = evaluate(visit, facts)
    assert [fact[:2] + fact[3:6] for fact in part] == [fact[:2] + fact[3:6] for fact in whole[:9]]


def test_a_file_from_before_steps_is_shown(visit: Visit, job: str) -> None:
    """Its nodes are those of the binary tree, and its extras have no splits."""
    mesh, hierarchy = two_strips()
    old = io.BytesIO()
    write_glb(old, mesh, hierarchy, all_levels=True)
    body = without_splits(old.getvalue())
    visit.page.route(
        "**/model.glb?levels=all", lambda route: route.fulfill(body=body, content_type="model/gltf-binary")
    )
    embed(visit, job)
    assert evaluate(visit, "v.tree.nodes.map((n) => n.parent)") == [-1, 0, 0, 2, 2]
    assert evaluate(visit, "v.tree.nodes.map((n) => n.cutValue)") == [0, None, 1.5, None, None]
    assert evaluate(visit, "[v.parts, v.tree.stepEnds, v.tree.childrenIn(v.tree.cutAt(3), 0)]") == [
        [1, 2],
        [1, 2, 3],
        [1, 2],
    ]


def without_splits(data: bytes) -> bytes:
    """A GLB file without the extras that steps have brought."""
    (length,) = struct.unpack_from("<I", data, 12)
    document, rest = json.loads(data[20 : 20 + length]), data[20 + length :]
    for name in ("split_node", "step", "cut_value", "limit_reached"):
        del document["scenes"][0]["extras"][name]
    for node in document["nodes"]:
        del node["extras"]["node"], node["extras"]["step"]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest


def test_events_report_loading_hovering_and_selecting(visit: Visit, job: str) -> None:
    embed(visit, job)
    visit.page.evaluate(
        """() => {
          window.events = [];
          for (const name of ['cleave-load', 'cleave-hover', 'cleave-select', 'cleave-error'])
            document.addEventListener(name, (event) => events.push([name, event.detail]));
          const viewer = document.querySelector('cleave-viewer');
          const source = viewer.getAttribute('src');
          viewer.removeAttribute('src');
          viewer.setAttribute('src', source);
        }"""
    )
    visit.page.wait_for_function("() => events.length > 0")
    visit.page.mouse.move(200, 150)
    visit.page.wait_for_function("() => events.length > 1")
    visit.page.mouse.click(200, 150)
    events = visit.page.evaluate("events")
    name, loaded = events[0]
    assert name == "cleave-load"
    assert loaded.pop("maxSegments") > 7
    assert loaded == {"automaticSegments": 7, "limitReached": False, "faces": 5120}
    assert [name for name, _ in events[1:]] == ["cleave-hover", "cleave-select"]
    assert events[2][1]["parts"] == [events[1][1]["part"]]


def test_a_file_that_is_not_a_model_is_an_error_event(visit: Visit, job: str) -> None:
    embed(visit, job)
    code = visit.page.evaluate(
        """() => new Promise((done) => {
          document.addEventListener('cleave-error', (event) => done(event.detail.code));
          document.querySelector('cleave-viewer').setAttribute('src', 'viewer/icon.svg');
        })"""
    )
    assert code == "invalid_model"


def test_a_moved_element_shows_its_model_again(visit: Visit, job: str) -> None:
    embed(visit, job)
    visit.page.evaluate(
        """() => new Promise((done) => {
          const viewer = document.querySelector('cleave-viewer');
          viewer.addEventListener('cleave-load', done, { once: true });
          const box = document.body.appendChild(document.createElement('div'));
          box.append(viewer);
        })"""
    )
    assert evaluate(visit, "v.partAt(200, 150 + v.getBoundingClientRect().top)") != -1


def shown_text(visit: Visit) -> str:
    """The text that the element shows in place of a model; empty if it shows none."""
    box = visit.page.locator("cleave-viewer p")
    return box.inner_text() if box.is_visible() else ""


def test_the_state_is_an_attribute_with_a_text(visit: Visit, job: str) -> None:
    held: list[Route] = []
    visit.page.route("**/model.glb?levels=all", lambda route: held.append(route))
    visit.page.route(
        "**/embedding",
        lambda route: route.fulfill(
            body=PAGE.format(job=job, query="?levels=all", attributes=""), content_type="text/html"
        ),
    )
    visit.open("embedding")
    visit.page.wait_for_selector("cleave-viewer[state=loading] p:visible")
    assert shown_text(visit) == "Loading the model…"
    visit.page.evaluate("document.addEventListener('cleave-load', (event) => (window.at = event.target.state))")
    held[0].continue_()
    visit.page.wait_for_selector("cleave-viewer[state=loaded]")
    assert (shown_text(visit), visit.page.evaluate("window.at")) == ("", "loaded")
    visit.page.evaluate("document.querySelector('cleave-viewer').removeAttribute('src')")
    visit.page.wait_for_selector("cleave-viewer[state=empty]")


def test_the_text_of_an_error_says_what_to_do(visit: Visit, job: str) -> None:
    embed(visit, job)
    visit.page.evaluate(
        "(path) => document.querySelector('cleave-viewer').setAttribute('src', path)", f"v1/jobs/{'0' * 32}/model.glb"
    )
    visit.page.wait_for_selector("cleave-viewer[state=failed]")
    said = "The model was not loaded. There is no job with this id: it was deleted, or the id is wrong."
    assert shown_text(visit) == said
    assert evaluate(visit, "v.error") == {"code": "not_loaded", "message": said}
    assert evaluate(visit, "v.tree") is None
    visit.forgive("404")
    visit.page.evaluate(
        "(path) => document.querySelector('cleave-viewer').setAttribute('src', path)", f"v1/jobs/{job}/model.glb"
    )
    visit.page.wait_for_selector("cleave-viewer[state=loaded]")
    assert (shown_text(visit), evaluate(visit, "v.error")) == ("", None)


def test_without_webgl_the_element_says_so(visit: Visit, job: str) -> None:
    visit.page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
    body = PAGE.format(job=job, query="", attributes="")
    visit.page.route("**/embedding", lambda route: route.fulfill(body=body, content_type="text/html"))
    visit.open("embedding")
    visit.page.wait_for_selector("cleave-viewer[state=failed]")
    assert "enable WebGL 2" in shown_text(visit)
    assert evaluate(visit, "v.error.code") == "no_webgl"
    visit.forgive("WebGL")


def test_a_page_of_another_origin_shows_models_if_it_is_allowed(
    new_visit: NewVisit, installation: Installation, other_site: OtherSite, job: str
) -> None:
    """As the example of docs/how-to/frontend.md, whose addresses are absolute."""
    (example,) = (block for block in blocks(read(FRONTEND), "html") if "cleave-viewer" in block)
    other_site.html = example.replace("http://127.0.0.1:8000", installation.url).replace(EXAMPLE_ID, job)
    for origin, state in ((other_site.allowed_origin, "loaded"), (other_site.refused_origin, "failed")):
        visit = new_visit()
        visit.page.goto(f"{origin}/")
        visit.page.wait_for_selector(f"cleave-viewer[state={state}]")
        if state == "failed":
            assert f"CLEAVE_CORS_ORIGINS there must contain {origin}." in shown_text(visit)
            visit.forgive("CORS", "ERR_FAILED")
        visit.foreign = [url for url in visit.foreign if not url.startswith(f"{origin}/")]
