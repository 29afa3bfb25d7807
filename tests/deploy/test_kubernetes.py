"""The Kubernetes manifests are valid and match the product."""

from itertools import chain
from pathlib import Path
from typing import Any

import kubernetes_validate
import pytest
import yaml

from cleave.settings import Settings
from worker.jobs.queue.queue import QUEUE_NAMES
from worker.jobs.size_class import SizeClass

FOLDER = Path(__file__).parents[2] / "deploy" / "kubernetes"
KUSTOMIZATION = yaml.safe_load((FOLDER / "kustomization.yaml").read_text())
COMPONENTS = ["ingress", "service-monitor"]


def resources(folder: Path) -> list[dict[str, Any]]:
    files = yaml.safe_load((folder / "kustomization.yaml").read_text())["resources"]
    return [document for file in files for document in yaml.safe_load_all((folder / file).read_text())]


DOCUMENTS = resources(FOLDER)
OPTIONAL = {name: resources(FOLDER / "components" / name) for name in COMPONENTS}
OF_OPERATORS = ("keda.sh/", "monitoring.coreos.com/")  # whose schemas are not those of Kubernetes
BUILT_IN = [one for one in [*DOCUMENTS, *chain(*OPTIONAL.values())] if not one["apiVersion"].startswith(OF_OPERATORS)]
WORKLOADS = {one["metadata"]["name"]: one for one in DOCUMENTS if one["kind"] in ("Deployment", "StatefulSet")}
OWN = ["service", "worker-small", "worker-large"]
SECRET_KEYS = {"redis-password", "aws-access-key-id", "aws-secret-access-key", "api-keys"}
VERSION = "1.33"


def name_of(document: dict[str, Any]) -> str:
    return f"{document['kind']}-{document['metadata']['name']}"


def named(kind: str) -> dict[str, dict[str, Any]]:
    return {one["metadata"]["name"]: one["spec"] for one in DOCUMENTS if one["kind"] == kind}


def pod(name: str) -> dict[str, Any]:
    spec: dict[str, Any] = WORKLOADS[name]["spec"]["template"]["spec"]
    return spec


def container(name: str) -> dict[str, Any]:
    (only,) = pod(name)["containers"]
    assert isinstance(only, dict)
    return only


def variables(name: str) -> dict[str, str]:
    return {one["name"]: str(one.get("value", "")) for one in container(name)["env"]}


@pytest.mark.parametrize("document", BUILT_IN, ids=name_of)
def test_every_manifest_is_valid(document: dict[str, Any]) -> None:
    kubernetes_validate.validate(document, VERSION, strict=True)


def test_every_file_belongs_to_the_kustomization() -> None:
    assert {path.name for path in FOLDER.glob("*.yaml")} == {*KUSTOMIZATION["resources"], "kustomization.yaml"}
    assert {path.name for path in (FOLDER / "components").iterdir()} == set(COMPONENTS)
    for name in COMPONENTS:
        assert f"#   - components/{name}\n" in (FOLDER / "kustomization.yaml").read_text()


@pytest.mark.parametrize("name", WORKLOADS)
def test_pods_have_a_read_only_root_no_privileges_and_no_access_to_the_cluster(name: str) -> None:
    assert pod(name)["securityContext"]["runAsNonRoot"] is True
    assert pod(name)["securityContext"]["seccompProfile"] == {"type": "RuntimeDefault"}
    assert pod(name)["automountServiceAccountToken"] is False
    assert container(name)["securityContext"] == {
        "allowPrivilegeEscalation": False,
        "readOnlyRootFilesystem": True,
        "capabilities": {"drop": ["ALL"]},
    }
    assert "readinessProbe" in container(name)
    assert set(container(name)["resources"]) == {"requests", "limits"}
    assert WORKLOADS[name]["spec"]["template"]["metadata"]["labels"]["app.kubernetes.io/name"] == name


@pytest.mark.parametrize("name", OWN)
def test_only_existing_settings_are_set_and_secrets_are_references(name: str) -> None:
    known = {f"CLEAVE_{field.upper()}" for field in Settings.model_fields}
    literals = [literal.partition("=")[0] for literal in KUSTOMIZATION["configMapGenerator"][0]["literals"]]
    given = [*variables(name), *literals]
    assert {variable for variable in given if variable.startswith("CLEAVE_")} <= known
    referred = [one["valueFrom"]["secretKeyRef"] for one in container(name)["env"] if "valueFrom" in one]
    assert {one["name"] for one in referred} == {"cleave"}
    assert {one["key"] for one in referred} <= SECRET_KEYS
    assert "Secret" not in {one["kind"] for one in DOCUMENTS}
    assert variables(name)["CLEAVE_REDIS_URL"] == "redis://:$(REDIS_PASSWORD)@redis:6379/0"
    assert {mount["mountPath"] for mount in container(name)["volumeMounts"]} == {"/data", "/tmp"}


@pytest.mark.parametrize("size", SizeClass)
def test_a_worker_is_scaled_by_its_queue_and_can_finish_its_job(size: SizeClass) -> None:
    name = f"worker-{size}"
    assert container(name)["args"][:3] == ["worker", "--queue", size]
    grace_s = float(variables(name)["CLEAVE_SHUTDOWN_GRACE_S"])
    assert grace_s >= float(variables(name)["CLEAVE_JOB_TIMEOUT_S"])
    assert pod(name)["terminationGracePeriodSeconds"] > grace_s + 10
    scaled = named("ScaledObject")[name]
    (trigger,) = scaled["triggers"]
    assert scaled["scaleTargetRef"] == {"name": name}
    assert scaled["minReplicaCount"] >= 1  # or /readyz would never be true
    assert "replicas" not in WORKLOADS[name]["spec"]
    assert trigger["type"] == "redis"
    assert trigger["metadata"]["listName"] == f"rq:queue:{QUEUE_NAMES[size]}"
    assert trigger["metadata"]["address"] == f"redis.{KUSTOMIZATION['namespace']}.svc:6379"
    assert trigger["authenticationRef"]["name"] in named("TriggerAuthentication")
    assert all(isinstance(value, str) for value in trigger["metadata"].values())


def test_names_and_ports_match() -> None:
    services = named("Service")
    for name, labels in {"cleave": "service", "redis": "redis"}.items():
        assert services[name]["selector"] == {"app.kubernetes.io/name": labels}
    (port,) = container("service")["ports"]
    assert (port["name"], port["containerPort"]) == ("http", 8000)  # the port that the Dockerfile exposes
    assert services["cleave"]["ports"][0]["targetPort"] == "http"
    policies = named("NetworkPolicy")
    assert policies["nothing"] == {"podSelector": {}, "policyTypes": ["Ingress", "Egress"]}
    assert policies["service"]["ingress"][0]["ports"] == [{"protocol": "TCP", "port": 8000}]
    assert policies["redis"]["ingress"][0]["ports"] == [{"protocol": "TCP", "port": 6379}]
    uses = policies["queue-and-store"]["podSelector"]["matchLabels"].items()
    for name in OWN:
        assert uses <= WORKLOADS[name]["spec"]["template"]["metadata"]["labels"].items()
    for name, budget in named("PodDisruptionBudget").items():
        assert budget["selector"]["matchLabels"] == {"app.kubernetes.io/name": name}


def test_the_ingress_leads_to_the_service_and_takes_the_largest_upload() -> None:
    (ingress,) = OPTIONAL["ingress"]
    (rule,) = ingress["spec"]["rules"]
    (path,) = rule["http"]["paths"]
    assert path["backend"]["service"] == {
        "name": "cleave",
        "port": {"name": named("Service")["cleave"]["ports"][0]["name"]},
    }
    assert path["path"] == Settings.model_fields["root_path"].default + "/"
    assert ingress["spec"]["tls"][0]["hosts"] == [rule["host"]]
    annotations = {name.rpartition("/")[2]: value for name, value in ingress["metadata"]["annotations"].items()}
    assert (
        int(annotations["proxy-body-size"].removesuffix("g")) * 2**30
        >= Settings.model_fields["max_batch_bytes"].default
    )
    assert int(annotations["proxy-read-timeout"]) > Settings.model_fields["max_stream_s"].default
    assert annotations["proxy-request-buffering"] == "off"


def test_the_service_monitor_selects_the_service_and_sends_a_key() -> None:
    (monitor,) = OPTIONAL["service-monitor"]
    (service,) = (one for one in DOCUMENTS if one["kind"] == "Service" and one["metadata"]["name"] == "cleave")
    assert monitor["spec"]["selector"]["matchLabels"] == service["metadata"]["labels"]
    (endpoint,) = monitor["spec"]["endpoints"]
    assert endpoint["port"] == service["spec"]["ports"][0]["name"]
    assert endpoint["path"] == "/metrics"
    assert endpoint["authorization"]["credentials"]["name"] == "cleave-metrics"


def test_the_queue_server_is_persistent_and_requires_a_password() -> None:
    arguments = container("redis")["args"]
    options = dict(zip(arguments[::2], arguments[1::2], strict=True))
    assert (options["--appendonly"], options["--maxmemory-policy"]) == ("yes", "noeviction")
    assert options["--requirepass"] == "$(REDISCLI_AUTH)"
