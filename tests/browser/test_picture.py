"""The picture: colours of the parts at every level, draw calls, and memory that is freed with the model."""

from helpers.browser.visit import Visit


def test_moving_the_slider_recolours_only_split_parts_and_sends_no_request(visit: Visit, job: str) -> None:
    visit.open_job(job)
    visit.page.click("#lines")
    places = _points_inside_leaves(visit)
    visit.settle()
    sent = len(visit.requests)
    previous = visit.parts_at(places), visit.colors_at(places)
    changed = recoloured = 0
    for segments in (8, 9, 15, 20):
        visit.set_range("level", segments)
        assert visit.page.inner_text("#level-number") == str(segments)
        visit.settle()
        parts, colors = visit.parts_at(places), visit.colors_at(places)
        keeps_label = visit.page.evaluate(
            """([was, is]) => {
              const { tree } = document.getElementById('viewer');
              return is.map((id, i) => id >= 0 && tree.node(id).label === tree.node(was[i]).label);
            }""",
            [previous[0], parts],
        )
        for kept, part, old, new in zip(keeps_label, parts, previous[1], colors, strict=True):
            difference = max(abs(a - b) for a, b in zip(old, new, strict=True))
            if kept:
                assert difference <= 2
            elif part >= 0:
                changed += 1
                recoloured += difference > 10
        previous = parts, colors
    assert recoloured == changed > 0
    assert visit.requests[sent:] == []


def test_the_picture_has_the_colours_of_the_list(visit: Visit, job: str) -> None:
    visit.open_job(job)
    swatches = visit.viewer("v.parts.map((id) => v.colorOf(id).match(/[0-9]+/g).map(Number))")
    places = visit.grid(16)
    found = list(zip(visit.parts_at(places), visit.colors_at(places), strict=True))
    for part, swatch in zip(visit.parts(), swatches, strict=True):
        pixels = [color[:3] for at, color in found if at == part]
        if len(pixels) < 10:
            continue
        mean = [sum(channel) / len(pixels) for channel in zip(*pixels, strict=True)]
        # Light changes the brightness of a colour, but not its strongest and its weakest channel.
        assert abs(swatch[mean.index(max(mean))] - max(swatch)) <= 12
        assert abs(swatch[mean.index(min(mean))] - min(swatch)) <= 12


def test_every_level_is_drawn_with_at_most_one_call_per_part(visit: Visit, job: str) -> None:
    visit.open_job(job)
    for segments in (2, 7, 30):
        visit.set_range("level", segments)
        visit.viewer("v.figures.frame()")
        assert 1 <= visit.viewer("v.figures.drawCalls()") <= segments


def test_the_memory_of_a_model_is_freed_with_it(visit: Visit, job: str) -> None:
    visit.open_job(job)
    first = _memory_with_everything(visit)
    for _ in range(3):
        visit.page.evaluate(
            """() => new Promise((done) => {
              const viewer = document.getElementById('viewer');
              viewer.addEventListener('cleave-load', done, { once: true });
              const source = viewer.getAttribute('src');
              viewer.removeAttribute('src');
              viewer.setAttribute('src', source);
            })"""
        )
        assert _memory_with_everything(visit) == first
    visit.page.click("#home")
    visit.page.wait_for_selector("#start:not([hidden])")
    assert visit.viewer("v.figures.memory().geometries") == 0


def _points_inside_leaves(visit: Visit) -> list[tuple[float, float]]:
    """Return points that are not near a border at any level; colours are mixed at borders."""
    visit.set_range("level", 64)
    places = visit.grid(12)
    around = [(0, 0), (2, 0), (-2, 0), (0, 2), (0, -2)]
    found = [visit.parts_at([(x + dx, y + dy) for x, y in places]) for dx, dy in around]
    visit.page.click("#level-automatic")
    return [place for place, *parts in zip(places, *found, strict=True) if len(set(parts)) == 1]


def _memory_with_everything(visit: Visit) -> dict[str, int]:
    visit.settle()
    visit.viewer("(v.toggleAttribute('wireframe', true), v.toggleAttribute('concavity', true), v.figures.frame())")
    memory: dict[str, int] = visit.viewer("v.figures.memory()")
    return memory


def test_the_concavity_overlay_marks_the_roots_of_the_arms(visit: Visit, job: str) -> None:
    visit.open_job(job, "&k=1")
    plain = visit.colors_at(visit.grid(14))
    visit.page.click("#concavity")
    visit.settle()
    shown = visit.colors_at(visit.grid(14))
    red = [color for color in shown if color[3] == 255 and color[0] > color[2] + 40]
    assert not [color for color in plain if color[3] == 255 and color[0] > color[2] + 40]
    assert 10 < len(red) < len([color for color in shown if color[3] == 255]) / 2


# Opens a job whose model is shown coarse first, and returns what the page is like at that time.
_OPEN_COARSE = """(job) => new Promise((done) => {
  const viewer = document.getElementById('viewer');
  viewer.setAttribute('coarse-from', '1000');
  viewer.addEventListener('cleave-coarse', ({ detail }) => {
    const box = viewer.getBoundingClientRect();
    done({
      ...detail,
      isShown: box.width > 0 && viewer.figures.drawCalls() >= 0,
      state: viewer.state,
      says: viewer.shadowRoot.querySelector('p').textContent,
      part: viewer.partAt(box.x + box.width / 2, box.y + box.height / 2),
      tools: getComputedStyle(document.getElementById('tools')).visibility,
    });
  });
  location.hash = `job=${job}`;
})"""


def test_a_large_model_is_shown_coarse_and_without_tools_until_the_full_one_is_there(visit: Visit, job: str) -> None:
    visit.open("")
    coarse = visit.page.evaluate(_OPEN_COARSE, job)
    assert coarse["isShown"]
    assert coarse["faces"] <= coarse["fullFaces"]
    assert (coarse["state"], coarse["part"], coarse["tools"]) == ("loading", -1, "hidden")
    assert coarse["says"] == "A coarse model; the full one follows."
    visit.wait_for_parts()
    assert visit.viewer("v.tree.node(0).faces") == coarse["fullFaces"]
    assert visit.viewer("v.state") == "loaded"
    assert max(visit.parts_at(visit.grid())) >= 0
    assert visit.page.evaluate("getComputedStyle(document.getElementById('tools')).visibility") == "visible"
