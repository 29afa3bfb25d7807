"""The service conforms to its OpenAPI document, checked with schemathesis."""

import json
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import httpx
import pytest
import schemathesis
from hypothesis import HealthCheck, given, seed, settings
from hypothesis.errors import Flaky
from redis import Redis
from schemathesis.config import SchemathesisConfig

from cleave.settings import Settings
from helpers.servers import serving, working
from service.keys import key_digest, new_key
from service.openapi.export import DOCS
from worker.jobs.queue.queue import QUEUE_NAMES
from worker.jobs.size_class import SizeClass
from worker.jobs.store.opening import open_store


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory, queue_url: str) -> Iterator[httpx.Client]:
    """A service with a worker and short timeouts."""
    limits = Settings(
        data_dir=tmp_path_factory.mktemp("contract"),
        redis_url=queue_url,
        max_upload_bytes=100_000,
        max_wait_s=0.2,
        max_stream_s=0.2,
        upload_idle_s=5.0,
        api_keys=f"tester:{key_digest(KEY)}",
    )
    with Redis.from_url(queue_url) as connection:
        connection.flushall()
        for size in SizeClass:
            connection.sadd(f"rq:workers:{QUEUE_NAMES[size]}", "rq:worker:tester")  # makes it ready
        connection.hset("rq:worker:tester", "state", "idle")
    with working(open_store(limits), limits), serving(limits) as client:
        yield client


pytestmark = pytest.mark.timeout(900)  # for the number of examples in CI
KEY = new_key()
_STARTS, _STEPS = 20, 8
COMMITTED = json.loads((DOCS / "openapi.json").read_text())
OPERATIONS = [(method, path) for path, operations in COMMITTED["paths"].items() for method in operations]
_OF_NO_INPUT = 20  # examples of operations whose requests are all the same


@pytest.fixture(scope="module")
def schema(service: httpx.Client) -> Any:
    # A schema cannot express which parameters exclude each other, how many segments a mesh has, which Idempotency-Key
    # was used before and which jobs are deleted. So valid requests may be refused as invalid, too large or gone.
    accepting = {"expected-statuses": ["2xx", 304, 401, 403, 404, 409, 410, 413, 422, 429]}
    config = SchemathesisConfig.from_dict(
        {
            "base-url": str(service.base_url),
            "auth": {"openapi": {"ApiKey": {"bearer": KEY}}},
            "checks": {"positive_data_acceptance": accepting},
        }
    )
    return schemathesis.openapi.from_dict(service.get("/openapi.json").json(), config=config)


@pytest.fixture(scope="module")
def max_examples(request: pytest.FixtureRequest) -> int:
    count: int = request.config.getoption("contract_examples")
    return count


@pytest.mark.parametrize(("method", "path"), OPERATIONS)
def test_every_response_is_as_documented(schema: Any, max_examples: int, method: str, path: str) -> None:
    operation = COMMITTED["paths"][path][method]
    has_input = "parameters" in operation or "requestBody" in operation

    @settings(
        max_examples=max_examples if has_input else min(max_examples, _OF_NO_INPUT),
        suppress_health_check=list(HealthCheck),
    )
    @given(case=schema[path][method].as_strategy())
    def check(case: schemathesis.Case) -> None:
        case.call_and_validate()

    check()


def test_every_response_is_as_documented_in_any_order_of_requests(schema: Any, max_examples: int) -> None:
    failures: list[Exception] = []
    answers = 0

    class Workflow(schema.as_state_machine()):  # type: ignore[misc]
        def validate_response(self, *arguments: Any, **options: Any) -> None:
            nonlocal answers
            answers += 1
            try:
                super().validate_response(*arguments, **options)
            except Exception as failure:
                failures.append(failure)
                raise

    # The state of the service changes, so that the same requests may get other responses, which hypothesis reports as
    # Flaky. The search then restarts with another seed; failures are kept.
    for start in range(_STARTS):
        with suppress(Flaky):
            seed(start)(Workflow).run(
                settings=settings(
                    max_examples=max_examples, stateful_step_count=_STEPS, suppress_health_check=list(HealthCheck)
                )
            )
        if failures:
            raise failures[0]
        if answers >= max_examples * _STEPS / 2:
            return
    raise AssertionError(f"only {answers} responses were checked")
