"""The segmented mesh as a file for other programs."""

from collections.abc import Callable, Mapping
from typing import Any, BinaryIO

from service.answer.level import ChosenCut
from service.answer.model_formats import MODELS, model_file
from service.answer.originals import stored_original
from service.answer.part_names import names_digest
from service.answer.renditions import Rendition, to_bytes
from service.context import Context
from service.result_cache import ResultCache


def model_rendition(
    context: Context, cut: ChosenCut, name: str, names: dict[int, str], options: Mapping[str, Any]
) -> Rendition:
    """Return the segmented mesh in a format.

    Parameters
    ----------
    name : a key of MODELS.
    names : names of segments by label, in place of those of a revision.
    options : further keyword arguments of the writer. If the value of ``keep`` is not None, the writer gets the stored
        file of the job in its place.
    """
    writer = MODELS[name]
    mesh, hierarchy = cut.result.mesh, cut.result.hierarchy
    query = cut.name + "".join(f"&{option}={value}" for option, value in options.items()) + names_digest(names)
    looks = {option: look for option, look in cut.looks(names).items() if option in ("names", *writer.options)}

    def write(target: BinaryIO) -> None:
        if options.get("keep") is None:
            writer.write(target, mesh, hierarchy, cut.segments, **looks, **options)
            return
        with stored_original(context, cut.job_id) as original:
            writer.write(target, mesh, hierarchy, cut.segments, **looks, **{**options, "keep": original})

    is_companion = any(one.companion == name for one in MODELS.values())  # a file that others refer to by its name
    file_name = model_file(name) if is_companion else f"{cut.job_id}{writer.extension}"
    return cached_rendition(context.results, cut, f"{name}?{query}", writer.media_type, write, file_name)


def cached_rendition(
    cache: ResultCache,
    cut: ChosenCut,
    name: str,
    media_type: str,
    write: Callable[[BinaryIO], object],
    file_name: str | None = None,
) -> Rendition:
    """Return a rendition whose bytes are kept in the cache by its name, with the level in it."""
    return Rendition(
        identity=f"{cut.job_id}/{name}",
        media_type=media_type,
        render=lambda: cache.rendered(cut.job_id, name, lambda: to_bytes(write)),
        file_name=file_name,
        may_change=cut.is_newest,
    )
