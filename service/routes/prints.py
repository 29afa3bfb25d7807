"""Files for printing, and what they contain."""

from fastapi import APIRouter
from starlette.responses import Response

from service.answer.part_names import PartNames
from service.answer.renditions import LEVEL_PROBLEMS, answer_rendition, rendition_responses
from service.answer.result_request import ResultRequestOf
from service.answer.revision import REVISION_PROBLEMS
from service.openapi.document import ref
from service.printing.documents import PrintDocument
from service.printing.query import PrintRequestOf
from service.printing.rendition import print_rendition, report_rendition

router = APIRouter(prefix="/v1/jobs/{job_id}", tags=["models"])

_PROBLEMS = (*LEVEL_PROBLEMS, *REVISION_PROBLEMS, "missing_package")


@router.get(
    "/print.3mf",
    response_class=Response,
    responses=rendition_responses(
        {"model/3mf": {"schema": {"type": "string", "format": "binary"}}}, "The file for printing.", *_PROBLEMS
    ),
)
def get_print(wanted: ResultRequestOf, names: PartNames, printing: PrintRequestOf) -> Response:
    """The parts as closed solids in millimetres with connectors, each with a filament."""
    return answer_rendition(wanted.request, print_rendition(wanted.context.results, wanted.cut(), names, printing))


@router.get(
    "/print.json",
    response_class=Response,
    responses=rendition_responses(
        {"application/json": {"schema": ref(PrintDocument)}}, "The report of a file for printing.", *_PROBLEMS
    ),
)
def get_print_report(wanted: ResultRequestOf, names: PartNames, printing: PrintRequestOf) -> Response:
    """What `print.3mf` contains with the same parameters: volumes, filaments, and why contacts have no connector."""
    return answer_rendition(wanted.request, report_rendition(wanted.context.results, wanted.cut(), names, printing))
