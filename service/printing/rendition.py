"""A result of a job as a file for printing, and the report of it."""

from typing import TYPE_CHECKING, BinaryIO

from segcore.printing.options import PrintOptions
from service.answer.label_formats import compact_json
from service.answer.level import ChosenCut
from service.answer.models import cached_rendition
from service.answer.part_names import names_digest
from service.answer.renditions import Rendition
from service.result_cache import ResultCache

if TYPE_CHECKING:
    from segcore.printing.plan import PrintPlan


def print_rendition(cache: ResultCache, cut: ChosenCut, names: dict[int, str], options: PrintOptions) -> Rendition:
    """Return the parts of a cut as 3MF for printing.

    Parameters
    ----------
    names : names of parts by label, in place of those of a revision.
    """

    def write(target: BinaryIO) -> None:
        from segcore.printing.writer import write_print

        write_print(target, _plan(cut, names, options))

    name = f"print.3mf?{_query(cut, names, options)}"
    return cached_rendition(cache, cut, name, "model/3mf", write, f"{cut.job_id}-print.3mf")


def report_rendition(cache: ResultCache, cut: ChosenCut, names: dict[int, str], options: PrintOptions) -> Rendition:
    """Return the report of the same file."""

    def write(target: BinaryIO) -> None:
        from segcore.printing.report import print_report

        target.write(compact_json(print_report(_plan(cut, names, options))))

    return cached_rendition(cache, cut, f"print.json?{_query(cut, names, options)}", "application/json", write)


def _plan(cut: ChosenCut, names: dict[int, str], options: PrintOptions) -> "PrintPlan":
    from segcore.printing.plan import plan_print

    mesh, hierarchy, partition = cut.result.mesh, cut.result.hierarchy, cut.partition
    if partition is None:
        return plan_print(mesh, hierarchy, cut.segments, options, names=names)
    looks = {"names": partition.names | names, "part_colors": partition.colors}
    return plan_print(mesh, hierarchy, cut.segments, options, **looks)


def _query(cut: ChosenCut, names: dict[int, str], options: PrintOptions) -> str:
    return f"{cut.name}&{options!r}{names_digest(names)}"
