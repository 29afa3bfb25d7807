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

        write_print(target, _plan(cut, names, printing))

    name = f"print.3mf?{_query(cut, names, printing)}"
    return cached_rendition(cache, cut, name, "model/3mf", write, f"{cut.job_id}-print.3mf")


def report_rendition(cache: ResultCache, cut: ChosenCut, names: dict[int, str], printing: PrintRequest) -> Rendition:
    """Return the report of the same file."""

    def write(target: BinaryIO) -> None:
        from segcore.printing.report import print_report

        target.write(compact_json(print_report(_plan(cut, names, printing))))

    return cached_rendition(cache, cut, f"print.json?{_query(cut, names, printing)}", "application/json", write)


def _plan(cut: ChosenCut, names: dict[int, str], printing: PrintRequest) -> "PrintPlan":
    from segcore.printing.plan import plan_print

    mesh, hierarchy, partition = cut.result.mesh, cut.result.hierarchy, cut.partition
    if mesh.coordinates.up is None:
        mesh = with_coordinates(mesh, up=printing.up)
    if partition is None:
        return plan_print(mesh, hierarchy, cut.segments, printing.options, names=names)
    looks = {"names": partition.names | names, "part_colors": partition.colors}
    return plan_print(mesh, hierarchy, cut.segments, printing.options, **looks)


def _query(cut: ChosenCut, names: dict[int, str], printing: PrintRequest) -> str:
    return f"{cut.name}&{printing!r}{names_digest(names)}"
