"""Write the generated documents and lists: ``python -m service.openapi.export``."""

import json
import tempfile
from pathlib import Path
from typing import Any

_ROOT = Path(__file__).parents[2]
DOCS = _ROOT / "docs"
PAGE_LISTS = _ROOT / "viewer" / "src" / "page" / "lists.json"


def contract() -> dict[str, Any]:
    """Return the OpenAPI document of an installation that requires API keys, without the version of the software."""
    from cleave.settings import Settings
    from service.app import create_app

    with tempfile.TemporaryDirectory() as folder:
        app = create_app(Settings(data_dir=Path(folder), redis_url="unix:///nowhere", auth="required"))
    document: dict[str, Any] = app.openapi()
    document["info"].pop("version")
    return document


def contract_text(document: dict[str, Any]) -> str:
    """Return the text of docs/openapi.json."""
    return json.dumps(document, indent=1, sort_keys=True) + "\n"


def page_lists_text() -> str:
    """Return the text of viewer/src/page/lists.json."""
    from service.openapi.page_lists import page_lists

    return json.dumps(page_lists(), indent=1) + "\n"


def main() -> None:
    """Write docs/openapi.json, docs/reference/api.md and viewer/src/page/lists.json."""
    from service.openapi.reference import markdown

    document = contract()
    (DOCS / "openapi.json").write_text(contract_text(document))
    (DOCS / "reference" / "api.md").write_text(markdown(document))
    PAGE_LISTS.write_text(page_lists_text())


if __name__ == "__main__":
    main()
