"""Middleware that records every request in the log, in the metrics and in a trace."""

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
_METHODS = ("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS")  # others would add labels without limit
_NO_ROUTE = "none"  # the label of a path that matches no route


class RequestLogMiddleware:
    """Counts, times and logs the requests of an application.

    It continues the trace of the client, or starts one: log lines of a request and its response carry the trace.
    """

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

        async def send_with_trace(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)["traceparent"] = trace.traceparent()
            await send(message)

        with about(trace=trace) as subject:
            try:
                await self._app(scope, receive, send_with_trace)
            except Exception as error:
                if status:  # the response has started, so it can only be aborted
                    raise
                await translate(error).response()(scope, receive, send_with_trace)
            finally:
                self._record(scope, subject, status, time.perf_counter() - began_at)

    def _record(self, scope: Scope, subject: Subject, status: int, took_s: float) -> None:
        route = getattr(scope.get("route"), "path", _NO_ROUTE)
        method = scope["method"] if route != _NO_ROUTE and scope["method"] in _METHODS else "any"
        self._metrics.requests.labels(method, route, status).inc()
        self._metrics.seconds.labels(route).observe(took_s)
        subject.job_id = subject.job_id or scope.get("path_params", {}).get("job_id")
        fields = {"method": scope["method"], "route": route, "status": status, "seconds": round(took_s, 4)}
        log.log(_level(scope["method"], route, status), "%s %s", scope["method"], route, extra={"fields": fields})


def _level(method: str, route: str, status: int) -> int:
    """Return WARNING for server errors, DEBUG for frequent requests, and INFO for the rest.

    Frequent are probes, reads and accepted submissions; their jobs have a line of their own when they end.
    """
    if (status >= 500 or not status) and route not in _PROBES:
        return logging.WARNING
    is_accepted = route == "/v1/jobs" and status < 400
    return logging.DEBUG if method in ("GET", "HEAD", "OPTIONS") or is_accepted else logging.INFO
