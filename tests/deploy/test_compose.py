"""Properties of docker-compose.yml that its schema does not cover."""

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from cleave.settings import Settings
from deploy.dockerfile import parse

ROOT = Path(__file__).parents[2]
COMPOSE = yaml.safe_load((ROOT / "docker-compose.yml").read_text())
WITH_TLS = yaml.safe_load((ROOT / "deploy" / "compose" / "tls.yml").read_text())
SERVICES: dict[str, dict[str, Any]] = COMPOSE["services"]
OWN = [name for name, service in SERVICES.items() if service["image"] == "cleave:local"]
LASTING = [name for name in SERVICES if name != "bucket"]  # which ends when it has created the bucket
CREDENTIALS = {"AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"}


def seconds(text: str) -> float:
    number, unit = re.fullmatch(r"(\d+)(s|m)", text).groups()  # type: ignore[union-attr]
    return float(number) * {"s": 1, "m": 60}[unit]


@pytest.mark.parametrize("name", SERVICES)
def test_containers_have_a_read_only_root_and_no_privileges(name: str) -> None:
    service = SERVICES[name]
    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert "no-new-privileges:true" in service["security_opt"]
    assert service["networks"] == ["cleave"]
    if name in OWN:
        assert parse((ROOT / "Dockerfile").read_text())[-1].last("USER").text == "10001:10001"
    elif name in LASTING:
        assert service["user"].split(":")[0] != "0"


@pytest.mark.parametrize("name", LASTING)
def test_every_lasting_container_has_a_health_check_and_is_restarted(name: str) -> None:
    service = SERVICES[name]
    in_the_image = parse((ROOT / "Dockerfile").read_text())[-1].last("HEALTHCHECK").text
    assert service.get("healthcheck", {}).get("test") or (name == "service" and "healthz" in in_the_image)
    assert service["restart"] == "unless-stopped"
    assert seconds(service["stop_grace_period"]) > 10


@pytest.mark.parametrize("size", ["small", "large"])
def test_a_stopped_worker_can_finish_its_job(size: str) -> None:
    worker = SERVICES[f"worker-{size}"]
    environment = worker["environment"]
    assert worker["command"][:3] == ["worker", "--queue", size]
    grace_s = float(environment["CLEAVE_SHUTDOWN_GRACE_S"])
    assert grace_s >= float(environment["CLEAVE_JOB_TIMEOUT_S"])
    assert seconds(worker["stop_grace_period"]) > grace_s + 10
    assert worker["deploy"]["replicas"] >= 1


def test_only_existing_settings_are_set() -> None:
    known = {f"CLEAVE_{name.upper()}" for name in Settings.model_fields} | CREDENTIALS
    for name in OWN:
        assert set(SERVICES[name]["environment"]) <= known, name


def test_the_queue_server_is_persistent_and_requires_a_password() -> None:
    command = SERVICES["redis"]["command"]
    options = dict(zip(command[1::2], command[2::2], strict=True))
    assert options["--appendonly"] == "yes"
    assert options["--maxmemory-policy"] == "noeviction"
    assert options["--requirepass"].startswith("${CLEAVE_REDIS_PASSWORD:?")
    assert "ports" not in SERVICES["redis"]


def test_only_the_port_of_the_service_is_published_to_this_machine() -> None:
    published = {name: service["ports"] for name, service in SERVICES.items() if "ports" in service}
    assert published == {"service": ["127.0.0.1:8000:8000"]}


def test_containers_share_only_the_queue_and_the_store() -> None:
    named = set(COMPOSE["volumes"])
    for name in OWN:
        assert not [volume for volume in SERVICES[name]["volumes"] if volume.split(":")[0] in named], name
        assert SERVICES[name]["environment"]["CLEAVE_STORE_URL"].startswith("s3://cleave?endpoint=http://store:7070")


def test_the_proxy_leads_to_the_service_which_requires_keys() -> None:
    proxy = WITH_TLS["services"]["proxy"]
    host, _, port = proxy["environment"]["UPSTREAM"].partition(":")
    assert set(WITH_TLS["services"]) - {"proxy"} == {host}
    assert SERVICES[host]["ports"] == [f"127.0.0.1:{port}:{port}"]
    assert WITH_TLS["services"][host]["environment"]["CLEAVE_AUTH"] == "required"
    named = set(re.findall(r"\{\$(\w+)\}", (ROOT / "deploy" / "compose" / "Caddyfile").read_text()))
    assert named == set(proxy["environment"])


def test_the_proxy_has_the_least_privileges_and_keeps_its_certificates() -> None:
    proxy = WITH_TLS["services"]["proxy"]
    assert proxy["read_only"] is True
    assert (proxy["cap_drop"], proxy["cap_add"]) == (["ALL"], ["NET_BIND_SERVICE"])
    assert "no-new-privileges:true" in proxy["security_opt"]
    files = [mount for mount in proxy["volumes"] if mount.startswith("./")]
    assert all((ROOT / mount.split(":")[0]).is_file() and mount.endswith(":ro") for mount in files)
    assert {mount.split(":")[0] for mount in proxy["volumes"]} - {files[0].split(":")[0]} == set(WITH_TLS["volumes"])
