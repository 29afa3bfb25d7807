"""The application: routes, errors and the OpenAPI document around one context."""

from importlib.metadata import PackageNotFoundError, version
from typing import Any

from fastapi import FastAPI

from service import about_routes, health, home, result_routes, routes
from service.context import Context, QueueView
from service.problems import MEDIA_TYPE, handle_problems
from service.results import ResultCache
from worker.queue import JobQueue, connect_impatiently
from worker.settings import Settings
from worker.store import LocalStore


def create_app(settings: Settings) -> FastAPI:
    """The service over the store and the queue that the settings name; ``redis_url`` must be set."""
    assert settings.redis_url, "the settings of an application have a redis_url"
    app = FastAPI(
        title="Cleave",
        summary="Cuts a 3D mesh into the parts that a person would name.",
        version=installed_version(),
        generate_unique_id_function=lambda route: route.name,
        redirect_slashes=False,
        redoc_url=None,
    )
    store = LocalStore(settings.data_dir)
    queue = JobQueue(connect_impatiently(settings.redis_url))
    app.state.context = Context(
        settings,
        store,
        queue,
        QueueView(queue),
        ResultCache(store, settings.result_cache_bytes, settings.rendered_cache_bytes),
    )
    for router in (home.router, health.router, routes.router, result_routes.router, about_routes.router):
        app.include_router(router)
    handle_problems(app)
    app.openapi = lambda: _with_problems_only(FastAPI.openapi(app))  # type: ignore[method-assign]
    return app


def installed_version() -> str:
    try:
        return version("cleave")
    except PackageNotFoundError:
        return "0+checkout"


def _with_problems_only(document: dict[str, Any]) -> dict[str, Any]:
    """Errors as they are answered here: FastAPI documents one media type for a route and a 422 body of its own."""
    for path in document["paths"].values():
        for responses in (operation["responses"] for operation in path.values()):
            for status, response in list(responses.items()):
                content = response.get("content", {})
                schema = content.get("application/json", {}).get("schema", {}).get("$ref", "")
                if schema.endswith("/ProblemDocument"):
                    content[MEDIA_TYPE] = content.pop("application/json")
                elif schema.endswith("/HTTPValidationError"):
                    del responses[status]
    for name in ("HTTPValidationError", "ValidationError"):
        document["components"]["schemas"].pop(name, None)
    return document
