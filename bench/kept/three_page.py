"""ThreePage: glTF files drawn and moved by three.js in a browser, without a network."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import unquote, urlsplit

import numpy as np

from bench.errors import BenchmarkError

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Route

    from segcore.arrays import FloatArray

_PAGE = Path(__file__).with_name("page.html")
_ORIGIN = "https://three.test"  # no host has this name
_TYPES = {".js": "text/javascript", ".wasm": "application/wasm"}


class ThreePage:
    """A page of a browser. ``models`` has the files by name: bytes of a GLB file, or the path of a file in its folder.

    Parameters
    ----------
    three : the folder of the npm package three.
    """

    def __init__(self, browser: Browser, three: Path) -> None:
        if not (three / "build" / "three.module.js").exists():
            raise BenchmarkError(f"There is no package three in {three}: run npm ci in viewer/, or give --three.")
        self.models: dict[str, bytes | Path] = {}
        self._three = three
        self._page = browser.new_page()
        self._page.route("**/*", self._answer)
        self._page.goto(f"{_ORIGIN}/page")
        self._page.wait_for_function("window.isReady")

    def differing_pixels(self, first: str, second: str, seconds: float) -> tuple[int, int]:
        """Return in how many pixels two models differ after some seconds of all animations, and how many are drawn."""
        found = self._page.evaluate("([a, b, s]) => difference(a, b, s)", [*self._urls(first, second), seconds])
        return found["differing"], found["drawn"]

    def triangles(self, name: str, seconds: float) -> FloatArray:
        """(F, 3, 3) the corners of all triangles after some seconds, in the order of the scene."""
        corners = self._page.evaluate("([name, s]) => triangles(name, s)", [*self._urls(name), seconds])
        return np.array(corners, dtype=np.float64).reshape(-1, 3, 3)

    def picture(self, name: str, seconds: float = 0.0, variant: str = "") -> bytes:
        """Return a picture as PNG, with the materials of a variant."""
        url = self._page.evaluate("([n, s, v]) => picture(n, s, v)", [*self._urls(name), seconds, variant])
        return base64.b64decode(url.partition(",")[2])

    def _urls(self, *names: str) -> list[str]:
        return [f"{name}/{model.name if isinstance((model := self.models[name]), Path) else 'x.glb'}" for name in names]

    def _answer(self, route: Route) -> None:
        kind, _, path = unquote(urlsplit(route.request.url).path).removeprefix("/").partition("/")
        found = self._file(kind, path)
        if found is None:
            route.fulfill(status=404, body="")
            return
        suffix = Path(path).suffix
        content_type = "text/html" if kind == "page" else _TYPES.get(suffix, "application/octet-stream")
        route.fulfill(body=found, content_type=content_type)

    def _file(self, kind: str, path: str) -> bytes | None:
        if kind == "page":
            return _PAGE.read_bytes()
        if kind == "three":
            return (self._three / path).read_bytes()
        name, _, rest = path.partition("/")
        model = self.models.get(name)
        if not isinstance(model, Path):
            return model
        file = model.parent / rest
        return file.read_bytes() if file.is_file() else None
