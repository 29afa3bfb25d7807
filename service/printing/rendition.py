"""A result of a job as a file for printing, and the report of it."""

from typing import TYPE_CHECKING, BinaryIO

from segcore.io import with_coordinates
from service.answer.label_formats import compact_json
from service.answer.level import ChosenCut
from service.answer.models import cached_rendition
from service.answer.part_names import names_digest
from service.answer.renditions import Rendition
from service.printing.query import PrintRequest
from service.result_cache import ResultCache

if TYPE_CHECKING:
    from segcore.printing.plan import PrintPlan


def print_rendition(cache: ResultCache, cut: ChosenCut, names: dict[int, str], printing: PrintRequest) -> Rendition:
    """Return the parts of a cut as 3MF for printing.

    Parameters
    ----------
    names : names of parts by label, in place of those of a revision.
    """

    def write(target: BinaryIO) -> None:
        from segcore.printing.writer import write_print

        plan = _plan(cut, names, printing)
        write_print(target, plan)
        # Who fetches the file often reads its report next, and the plan takes most of the time of both.
        cache.rendered(cut.job_id, _name("print.json", cut, names, printing), lambda: _report(plan))

    name = _name("print.3mf", cut, names, printing)
    return cached_rendition(cache, cut, name, "model/3mf", write, f"{cut.job_id}-print.3mf")


def report_rendition(cache: ResultCache, cut: ChosenCut, names: dict[int, str], printing: PrintRequest) -> Rendition:
    """Return the report of the same file."""

    def write(target: BinaryIO) -> None:
        target.write(_report(_plan(cut, names, printing)))

    return cached_rendition(cache, cut, _name("print.json", cut, names, printing), "application/json", write)


def _report(plan: "PrintPlan") -> bytes:
    from segcore.printing.report import print_report

    return compact_json(print_report(plan))


def _plan(cut: ChosenCut, names: dict[int, str], printing: PrintRequest) -> "PrintPlan":
    from segcore.printing.plan import plan_print

    mesh = cut.result.mesh
    if mesh.coordinates.up is None:
        mesh = with_coordinates(mesh, up=printing.up)
    return plan_print(mesh, cut.result.hierarchy, cut.segments, printing.options, **cut.looks(names))


def _name(file: str, cut: ChosenCut, names: dict[int, str], printing: PrintRequest) -> str:
    """The name of a rendition in the cache."""
    return f"{file}?{cut.name}&{printing!r}{names_digest(names)}"
