"""What the page shows: formats, stages of a job, the name of a part that has none, and options of prints."""

from typing import Any

from segcore.io import DEFAULT_SEGMENT_NAME, FORMATS
from service.answer.model_formats import MODELS, model_file
from service.printing.choices import print_choices
from worker.process.progress import REPORTED_STAGES

_STAGE_TITLES = {
    "reading": "Reading the file",
    "clean": "Cleaning the surface",
    "affinity": "Finding concavities",
    "coarsen": "Grouping faces",
    "cut": "Finding the best cuts",
    "label": "Labelling the parts",
}


def page_lists() -> dict[str, Any]:
    """Return the lists; ``path`` of a format is relative to the path of its job."""
    return {
        "inputFormats": [
            {"name": name, "title": one.title, "extensions": list(one.extensions)} for name, one in FORMATS.items()
        ],
        "formats": [
            {"name": name, "title": writer.title, "extension": writer.extension, "path": model_file(name)}
            for name, writer in MODELS.items()
            if name not in {one.companion for one in MODELS.values()}
        ],
        "stages": [{"name": stage, "title": _STAGE_TITLES[stage]} for stage in REPORTED_STAGES],
        "segmentName": DEFAULT_SEGMENT_NAME,
        "print": print_choices(),
    }
