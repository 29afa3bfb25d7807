"""The formats of the segmented mesh with their paths: every writer of segcore that can write names of segments."""

from segcore.io import WRITERS, Writer

MODELS: dict[str, Writer] = {name: writer for name, writer in WRITERS.items() if "names" in writer.options}
_LINKS = {"glb": "model", "3mf": "threemf"}  # the others are called as the operation


def operation_name(name: str) -> str:
    """Return the name of the operation of a format: ``parts`` if it writes a file per segment, else its own name."""
    return "parts" if "part_format" in MODELS[name].options else name


def model_file(name: str) -> str:
    """Return the last part of the path of a model, such as ``model.glb`` and ``parts.zip``."""
    stem = "parts" if operation_name(name) == "parts" else "model"
    return stem + MODELS[name].extension


def model_links(path: str) -> dict[str, str]:
    """Return the paths of the models of a job by the names of its links; ``path`` is that of the job."""
    return {_LINKS.get(name, operation_name(name)): f"{path}/{model_file(name)}" for name in MODELS}
