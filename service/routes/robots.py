"""Parts as robots for simulators, and what they consist of."""

from fastapi import APIRouter
from starlette.responses import Response

from service.answer.part_names import PartNames
from service.answer.renditions import LEVEL_PROBLEMS, answer_rendition, rendition_responses
from service.answer.result_request import ResultRequestOf
from service.answer.revision import REVISION_PROBLEMS
from service.openapi.document import ref
from service.robots.documents import RobotDocument
from service.robots.query import RobotOptionsOf
from service.robots.rendition import robot_rendition, robot_report_rendition

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["models"])

_PROBLEMS = (*LEVEL_PROBLEMS, *REVISION_PROBLEMS, "missing_package")


@router.get(
    "/robot.zip",
    response_class=Response,
    responses=rendition_responses(
        {"application/zip": {"schema": {"type": "string", "format": "binary"}}}, "The robot.", *_PROBLEMS
    ),
)
def get_robot(wanted: ResultRequestOf, names: PartNames, options: RobotOptionsOf) -> Response:
    """The parts as links in metres with z up: URDF, MJCF, meshes, convex pieces for collisions, and the report."""
    return answer_rendition(wanted.request, robot_rendition(wanted.context.results, wanted.cut(), names, options))


@router.get(
    "/robot.json",
    response_class=Response,
    responses=rendition_responses(
        {"application/json": {"schema": ref(RobotDocument)}}, "The report of a robot.", *_PROBLEMS
    ),
)
def get_robot_report(wanted: ResultRequestOf, names: PartNames, options: RobotOptionsOf) -> Response:
    """The report in `robot.zip` with the same parameters: links, masses, joints, and why parts have no volume."""
    rendition = robot_report_rendition(wanted.context.results, wanted.cut(), names, options)
    return answer_rendition(wanted.request, rendition)
