"""Formats and parameters of an installation."""

import httpx

from helpers.jobs import sphere


def test_formats_and_methods_describe_valid_requests(client: httpx.Client) -> None:
    formats = client.get("/v1/formats").json()
    assert {"off", "stl", "ply", "obj", "glb"} <= {form["name"] for form in formats["meshes"]}
    assert formats["max_upload_bytes"] == 200_000
    assert formats["keys_required"] is False
    schema = client.get("/v1/methods").json()
    answer = client.post("/v1/jobs", files={"mesh": ("mesh.off", sphere(12))})
    for name, value in answer.json()["parameters"].items():
        assert schema["properties"][name]["default"] == value
