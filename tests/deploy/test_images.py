"""No image of the deployment files can change by itself."""

import re
from pathlib import Path

import pytest
import yaml

from deploy.dockerfile import parse

ROOT = Path(__file__).parents[2]
# A version of three numbers, a release of the product itself, or a digest.
PINNED = re.compile(r".+(:v?\d+\.\d+\.\d+[\w.-]*|@sha256:[0-9a-f]{64})")
BUILT = "cleave:local"  # by docker-compose.yml, from the Dockerfile


def composed() -> list[str]:
    files = [ROOT / "docker-compose.yml", *(ROOT / "deploy" / "compose").glob("*.yml")]
    services = [service for file in files for service in yaml.safe_load(file.read_text())["services"].values()]
    return [re.sub(r"\$\{\w+:-(.*)\}", r"\1", service["image"]) for service in services if "image" in service]


def bases() -> list[str]:
    return [stage.base for stage in parse((ROOT / "Dockerfile").read_text())]


def orchestrated() -> list[str]:
    """The images of all containers, with the names and tags that the kustomization gives them."""
    folder = ROOT / "deploy" / "kubernetes"
    given = yaml.safe_load((folder / "kustomization.yaml").read_text())["images"]
    names = {one["name"]: f"{one['newName']}:{one['newTag']}" for one in given}
    found = re.findall(
        r"^ *image: (\S+)$", "\n".join(path.read_text() for path in folder.rglob("*.yaml")), re.MULTILINE
    )
    return [names.get(image, image) for image in found]


@pytest.mark.parametrize("image", sorted({*composed(), *bases(), *orchestrated()} - {BUILT}))
def test_every_image_is_pinned(image: str) -> None:
    assert PINNED.fullmatch(image)


@pytest.mark.parametrize(
    "image", ["valkey/valkey", "valkey/valkey:latest", "valkey/valkey:8.1-bookworm", "a/b@sha256:12"]
)
def test_an_image_that_can_change_is_found(image: str) -> None:
    assert not PINNED.fullmatch(image)


def test_the_same_queue_server_runs_everywhere() -> None:
    assert {image for image in composed() if "valkey" in image} == {
        image for image in orchestrated() if "valkey" in image
    }
