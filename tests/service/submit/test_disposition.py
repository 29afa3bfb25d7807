"""File names in Content-Disposition headers."""

import httpx
import pytest

from helpers.jobs import sphere
from service.submit.disposition import file_name_in


@pytest.mark.parametrize(
    ("header", "name"),
    [
        ('attachment; filename="a b.obj"', "a b.obj"),
        ("attachment; filename=a.obj", "a.obj"),
        ('form-data; name="mesh"; filename="naïve.obj"', "naïve.obj"),
        ("attachment; filename*=UTF-8''na%C3%AFve.obj", "naïve.obj"),
        ("attachment; filename=\"naive.obj\"; filename*=UTF-8''na%C3%AFve.obj", "naïve.obj"),
        ("attachment; filename*=UTF-8''na%C3%AFve.obj; filename=\"naive.obj\"", "naïve.obj"),
        ("attachment; FileName*= iso-8859-1'en'%A3%20rates.stl", "£ rates.stl"),
        ("attachment; filename*=klingon''a.obj; filename=b.obj", "b.obj"),
        ("attachment; filename*=UTF-8''%FF.obj", "\ufffd.obj"),
        ("attachment", None),
        ("", None),
    ],
)
def test_a_name_is_read_in_both_forms(header: str, name: str | None) -> None:
    assert file_name_in(header.encode()) == name


def test_a_raw_body_has_the_name_of_its_header(client: httpx.Client) -> None:
    headers = {
        "Content-Type": "application/octet-stream",
        "Content-Disposition": "attachment; filename*=UTF-8''%E6%89%8B.off",
    }
    job = client.post("/v1/jobs", content=sphere(12), headers=headers).json()
    assert (job["input"]["file_name"], job["input"]["format"]) == ("手.off", "off")
    named = client.post("/v1/jobs?file_name=hand.off", content=sphere(12), headers=headers).json()
    assert named["input"]["file_name"] == "hand.off"


def test_a_field_of_a_form_may_have_an_extended_name(client: httpx.Client) -> None:
    disposition = b'form-data; name="mesh"; filename="_.off"; filename*=UTF-8\'\'%E6%89%8B.off'
    body = b"--x\r\nContent-Disposition: " + disposition + b"\r\n\r\n" + sphere(12) + b"\r\n--x--\r\n"
    headers = {"Content-Type": "multipart/form-data; boundary=x"}
    job = client.post("/v1/jobs", content=body, headers=headers).json()
    assert job["input"]["file_name"] == "手.off"
