"""A result of a job as a robot, and the report of it."""

import io
import zipfile
from typing import BinaryIO

from segcore.robots.options import RobotOptions
from service.answer.level import ChosenCut
from service.answer.models import cached_rendition
from service.answer.part_names import names_digest
from service.answer.renditions import Rendition
from service.result_cache import ResultCache


def robot_rendition(cache: ResultCache, cut: ChosenCut, names: dict[int, str], options: RobotOptions) -> Rendition:
    """Return the parts of a cut as the links of a robot.

    Parameters
    ----------
    names : names of parts by label, in place of those of a revision.
    """

    def write(target: BinaryIO) -> None:
        from segcore.robots.plan import plan_robot
        from segcore.robots.writer import write_robot

        result = cut.result
        write_robot(target, plan_robot(result.mesh, result.hierarchy, cut.segments, options, **cut.looks(names)))

    name = f"robot.zip?{cut.name}&{options!r}{names_digest(names)}"
    return cached_rendition(cache, cut, name, "application/zip", write, f"{cut.job_id}-robot.zip")


def robot_report_rendition(
    cache: ResultCache, cut: ChosenCut, names: dict[int, str], options: RobotOptions
) -> Rendition:
    """Return the report in the archive of the same robot, which is made once for both."""
    whole = robot_rendition(cache, cut, names, options)

    def write(target: BinaryIO) -> None:
        from segcore.robots.writer import REPORT

        target.write(zipfile.ZipFile(io.BytesIO(whole.render())).read(REPORT))

    name = f"robot.json?{cut.name}&{options!r}{names_digest(names)}"
    return cached_rendition(cache, cut, name, "application/json", write)
