"""The application: routes, middleware, error handlers and OpenAPI document."""

from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

from fastapi import Depends, FastAPI
from starlette.middleware.cors import CORSMiddleware
from starlette.routing import Route

from cleave.settings import Settings
from cleave.version import installed_version
from service.answer.endings import Endings
from service.context import Context, QueueView
from service.edit.editors import Editors
from service.guard.foreign_sites import CrossSiteCheckMiddleware, HostCheckMiddleware
from service.guard.headers import HeadMiddleware, SecurityHeadersMiddleware
from service.guard.unknown_parameters import refuse_unknown_parameters
from service.keys import key_ring
from service.mcp.endpoint import AgentEndpoint
from service.mount import MountMiddleware
from service.openapi.document import complete
from service.problems import handle_problems
from service.result_cache import ResultCache
from service.routes import (
    about,
    batches,
    docs_page,
    edits,
    files,
    health,
    home,
    jobs,
    models,
    pictures,
    prints,
    results,
    robots,
    submission,
    webhooks,
)
from service.telemetry.metrics import Metrics
from service.telemetry.request_log import RequestLogMiddleware
from worker.jobs.queue.connection import connect
from worker.jobs.queue.queue import JobQueue
from worker.jobs.queue.quota import UploadQuota
from worker.jobs.store.opening import open_store

_EXPOSED_HEADERS = (
    "Location",
    "Retry-After",
    "ETag",
    "Content-Disposition",
    "Content-Range",
    "Preference-Applied",
    "RateLimit",
    "RateLimit-Policy",
    "traceparent",
)
_PAGES = (home, docs_page, health)
_ROUTES = (
    submission,
    jobs,
    results,
    models,
    pictures,
    prints,
    robots,
    files,
    edits,
    batches,
    about,
    webhooks,
)


def create_app(settings: Settings) -> FastAPI:
    """Return the application for some settings; ``redis_url`` must be set."""
    assert settings.redis_url, "redis_url must be set"
    app = FastAPI(
        title="Cleave",
        summary="Cuts a 3D mesh into the parts that a person would name.",
        version=installed_version(),
        generate_unique_id_function=lambda route: route.name,
        redirect_slashes=False,
        lifespan=_lifespan,
        docs_url=None,
        redoc_url=None,
    )
    store = open_store(settings)
    keys = key_ring(settings)
    queue = JobQueue(connect(settings.redis_url))
    metrics = Metrics(store, queue, settings.data_dir)
    app.state.context = Context(
        settings=settings,
        version=app.version,
        store=store,
        queue=queue,
        view=QueueView(queue),
        quota=UploadQuota(queue.connection),
        results=ResultCache(store, settings.result_cache_bytes, settings.rendered_cache_bytes),
        secret=store.secret,
        keys=keys,
        metrics=metrics,
        batches=store.batches,
        editors=Editors(settings),
        endings=Endings(settings.redis_url),
        keys_required=settings.auth == "required" or (settings.auth == "auto" and bool(keys.all())),
    )
    for module in _PAGES:
        app.include_router(module.router)
    for module in _ROUTES:
        app.include_router(module.router, dependencies=[Depends(refuse_unknown_parameters)])
    app.state.agents = AgentEndpoint(app)
    app.router.routes.append(Route("/mcp", app.state.agents, methods=["POST"]))
    _add_middleware(app, settings)
    app.add_middleware(RequestLogMiddleware, metrics=metrics)
    app.add_middleware(SecurityHeadersMiddleware)
    app.add_middleware(HeadMiddleware)
    app.add_middleware(MountMiddleware, root_path=settings.root_path)  # around all others
    handle_problems(app)
    complete(app, keys_required=app.state.context.keys_required)
    return app


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    """Listen to the ends of jobs while the application runs, and end the processes of edits with it."""
    context: Context = app.state.context
    async with context.endings.listening(), app.state.agents.serving():
        yield
    context.editors.stop()


def _add_middleware(app: FastAPI, settings: Settings) -> None:
    origins = settings.allowed_origins()
    app.add_middleware(CrossSiteCheckMiddleware, allowed_origins=origins)
    if settings.auth == "auto" and not app.state.context.keys_required:
        app.add_middleware(HostCheckMiddleware)
    if origins:
        app.add_middleware(
            CORSMiddleware,
            allow_origins=origins,
            allow_methods=["GET", "POST", "PUT", "DELETE"],
            allow_headers=["*"],
            expose_headers=list(_EXPOSED_HEADERS),
            max_age=600,
        )
