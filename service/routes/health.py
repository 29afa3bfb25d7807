"""Health, readiness and metrics."""

from fastapi import APIRouter
from prometheus_client.exposition import CONTENT_TYPE_PLAIN_1_0_0, generate_latest
from starlette.responses import Response

from service.context import Context, ContextOf
from service.documents import CompilationDocument, Health, Readiness
from service.guard.callers import CallerOf
from service.problems import documented
from worker.jobs.queue.compilation import Compilation, current_compilation
from worker.jobs.queue.connection import QueueError
from worker.jobs.queue.workers import worker_counts
from worker.jobs.size_class import SizeClass

router = APIRouter(tags=["health"])


@router.get("/healthz", response_model=Health)
async def get_health() -> Health:
    """The process responds."""
    return Health()


@router.get(
    "/readyz", response_model=Readiness, responses={503: {"model": Readiness, "description": "Something is missing."}}
)
def get_readiness(response: Response, context: ContextOf) -> Readiness:
    """A submitted job would run now: the queue answers, the store is writable, and both queues have workers."""
    readiness = _readiness(context)
    response.status_code = 200 if readiness.ready else 503
    return readiness


@router.get(
    "/metrics",
    response_class=Response,
    responses={
        200: {
            "content": {"text/plain": {"schema": {"type": "string"}}},
            "description": "In the text format of Prometheus.",
        },
        **documented("unauthorized"),
    },
)
def get_metrics(context: ContextOf, caller: CallerOf) -> Response:  # noqa: ARG001
    """Metrics for Prometheus. If API keys are required, any key is accepted."""
    return Response(generate_latest(context.metrics.registry), headers={"Content-Type": CONTENT_TYPE_PLAIN_1_0_0})


def _readiness(context: Context) -> Readiness:
    workers = _worker_counts(context)
    compilation = _compilation(context) if workers is not None else None
    store = _is_writable(context)
    sentences = {
        "The queue server does not answer.": workers is None,
        "The store cannot be written.": not store,
        **{f"No worker for {size} jobs is ready.": not (workers or {}).get(size) for size in SizeClass},
    }
    missing = [sentence for sentence, applies in sentences.items() if applies]
    count = sum((workers or {}).values())
    if missing and compilation is not None:
        missing.append(f"The workers are {compilation}.")
    return Readiness(
        ready=not missing,
        queue=workers is not None,
        store=store,
        workers=count,
        missing=missing,
        compilation=None
        if compilation is None
        else CompilationDocument(done=compilation.done, count=compilation.count),
    )


def _compilation(context: Context) -> Compilation | None:
    try:
        return current_compilation(context.queue.connection)
    except QueueError:
        return None


def _worker_counts(context: Context) -> dict[SizeClass, int] | None:
    try:
        return worker_counts(context.queue.connection)
    except QueueError:
        return None


def _is_writable(context: Context) -> bool:
    try:
        context.store.check_writable()
    except OSError:
        context.metrics.store_failed()
        return False
    return True
