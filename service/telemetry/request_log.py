"""Every request in the log, in the metrics and in a trace."""

import logging
import time

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from cleave.logs import Subject, about
from cleave.trace import new_trace, parse_traceparent
from service.problems import translate
from service.telemetry.metrics import Metrics

log = logging.getLogger("cleave.requests")

_PROBES = ("/healthz", "/readyz", "/metrics")
_METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")  # clients can make up others without end
_NOWHERE = "none"  # the route of a path that there is not


class ObservedRequests:
    """Counts and times the answers of an application, logs them, and ties what they log to the trace of the client."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        parent = parse_traceparent(Headers(scope=scope).get("traceparent"))
        trace = parent.child() if parent else new_trace()
        status, began_at = 0, time.perf_counter()

        async def noted_send(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)["traceparent"] = trace.traceparent()
            await send(message)

        with about(trace=trace) as subject:
            try:
                await self._app(scope, receive, noted_send)
            except Exception as error:
                if status:  # the answer has begun, so there is no other way to say it than to break it off
                    raise
                await translate(error).response()(scope, receive, noted_send)
            finally:
                self._note(scope, subject, status, time.perf_counter() - began_at)

    def _note(self, scope: Scope, subject: Subject, status: int, took_s: float) -> None:
        route = getattr(scope.get("route"), "path", _NOWHERE)
        method = scope["method"] if route != _NOWHERE and scope["method"] in _METHODS else "any"
        self._metrics.requests.labels(method, route, status).inc()
        self._metrics.seconds.labels(route).observe(took_s)
        subject.job_id = subject.job_id or scope.get("path_params", {}).get("job_id")
        fields = {"method": scope["method"], "route": route, "status": status, "seconds": round(took_s, 4)}
        log.log(_level(scope["method"], route, status), "%s %s", scope["method"], route, extra={"fields": fields})


def _level(method: str, route: str, status: int) -> int:
    """Polls and probes are many and say little: they are for debugging, polls as long as they succeed."""
    if (status >= 500 or not status) and route not in _PROBES:
        return logging.WARNING
    return logging.DEBUG if method in ("GET", "HEAD", "OPTIONS") else logging.INFO
