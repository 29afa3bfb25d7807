"""Pictures from any side, and what is seen at their pixels."""

from collections.abc import Callable

import httpx

from helpers.api import problem


def test_the_view_is_that_of_the_picture(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    camera = {"azimuth": 180, "elevation": 0, "size": 64, "segments": 4}
    labels = client.get(f"{path}/labels", params={"segments": 4, "format": "json"}).json()["labels"]
    view = client.get(f"{path}/view", params=camera | {"at": ["32,32", "0,0", "32,40"]}).json()
    assert (view["size"], view["segments"]) == (64, 4)
    assert {part["number"] for part in view["parts"]} <= {0, 1, 2, 3}
    middle, corner, below = view["points"]
    assert (corner["face"], corner["part"]) == (None, None)
    assert middle["part"] == labels[middle["face"]]
    assert {middle["face"], below["face"]} <= set(view["faces"])
    one = client.get(f"{path}/preview.png", params=camera).content
    assert one == client.get(f"{path}/preview.png", params=camera).content
    assert one != client.get(f"{path}/preview.png", params=camera | {"azimuth": 90}).content
    assert one != client.get(f"{path}/preview.png", params=camera | {"numbers": True}).content


def test_a_pixel_that_is_none_is_refused(client: httpx.Client, finished_job: Callable[..., str]) -> None:
    path = finished_job()
    for pixel in ("64,0", "a,b", "3", "-1,0", "\u00b2,0"):
        answer = client.get(f"{path}/view", params={"size": 64, "at": pixel})
        assert "pixel" in str(problem(answer, 422, "invalid_parameters")["detail"]).lower()
    problem(client.get(f"{path}/view", params={"elevation": 91}), 422, "invalid_request")
    problem(client.get(f"{path}/view", params={"at": ["1,1"] * 101}), 422, "invalid_request")
    problem(client.get(f"{path}/preview.png", params={"azimuth": "nan"}), 422, "invalid_request")
