"""Writes docs/openapi.json and docs/api.md: ``python -m service.openapi.export``."""

import json
import tempfile
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parents[2] / "docs"


def contract() -> dict[str, Any]:
    """The document of an installation that requires API keys, whatever the version of the software."""
    from cleave.settings import Settings
    from service.app import create_app

    with tempfile.TemporaryDirectory() as folder:
        app = create_app(Settings(data_dir=Path(folder), redis_url="unix:///nowhere", auth="required"))
    document: dict[str, Any] = app.openapi()
    document["info"].pop("version")
    return document


def contract_text(document: dict[str, Any]) -> str:
    return json.dumps(document, indent=1, sort_keys=True) + "\n"


def main() -> None:
    from service.openapi.reference import markdown

    document = contract()
    (DOCS / "openapi.json").write_text(contract_text(document))
    (DOCS / "api.md").write_text(markdown(document))


if __name__ == "__main__":
    main()
