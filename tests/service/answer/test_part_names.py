"""Names of segments that a client gives are written to the files."""

import io
import re
import zipfile
from collections.abc import Callable

import httpx
import pytest

from helpers.api import problem

NAMES = [("segments", "2"), ("name", "1:left arm"), ("name", "7:nobody")]


def test_every_model_contains_the_names(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    job = finished_job()
    for path, words in {
        "model.glb": b'"left arm"',
        "model.ply": b"comment label 1 is left arm",
        "model.obj": b"o left_arm",
    }.items():
        named = client.get(f"{job}/{path}", params=NAMES)
        assert words in named.content
        plain = client.get(f"{job}/{path}", params=NAMES[:1])
        assert words not in plain.content
        assert plain.headers["ETag"] != named.headers["ETag"]
    with zipfile.ZipFile(io.BytesIO(client.get(f"{job}/model.3mf", params=NAMES).content)) as package:
        assert b'"left arm"' in package.read("3D/3dmodel.model")
    with zipfile.ZipFile(io.BytesIO(client.get(f"{job}/parts.zip", params=NAMES).content)) as archive:
        assert archive.namelist() == ["segment_0.stl", "segment_1_left_arm.stl", "parts.json"]


@pytest.mark.parametrize("name", ["left arm", "1:", "-1:x", ":x", "1: "])
def test_a_malformed_name_is_refused(client: httpx.Client, finished_job: Callable[..., str], name: str) -> None:
    answer = client.get(f"{finished_job()}/model.obj", params={"name": name})
    problem(answer, 422, "invalid_parameters")
    assert "LABEL:NAME" in answer.json()["detail"]


def test_a_name_is_escaped(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    name = '0:../../etc/x"\n<a b="'
    job = finished_job()
    with zipfile.ZipFile(io.BytesIO(client.get(f"{job}/parts.zip", params={"name": name}).content)) as archive:
        assert re.fullmatch("segment_0+_etc_x_a_b.stl", archive.namelist()[0])
    lines = client.get(f"{job}/model.obj", params={"name": name}).text.splitlines()
    assert next(line for line in lines if line.startswith("o ")).startswith('o ../../etc/x"')
