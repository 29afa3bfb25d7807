"""`cleave submit`: results are saved in a folder, no job is run twice, and the exit status reports failures."""

import io
import json
import os
import zipfile
from pathlib import Path

import pytest
import trimesh

from cleave.client import Client
from helpers.files.samples import TWO_SQUARES, gltf_square
from helpers.jobs import sphere
from service.commands.main import main
from service.commands.submit_record import RECORD


@pytest.fixture
def meshes(tmp_path: Path) -> list[Path]:
    paths = [tmp_path / f"ball{rows}.off" for rows in (10, 11)]
    for path in paths:
        path.write_bytes(sphere(int(path.stem[4:])))
    return paths


def submit(url: str, files: list[Path], folder: Path, *options: str) -> int:
    return main(["submit", *map(str, files), "--server", url, "-o", str(folder), *options])


def results_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir() if path.name != RECORD)


def test_every_file_gets_its_results(
    url: str, meshes: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert submit(url, meshes, tmp_path / "out", "--segments", "3") == 0
    assert results_in(tmp_path / "out") == [
        f"{mesh.stem}.{ending}" for mesh in meshes for ending in ("glb", "json", "seg")
    ]
    assert set((tmp_path / "out" / "ball10.seg").read_text().split()) == {"0", "1", "2"}
    printed = capsys.readouterr()
    assert "2 of 2 files" in printed.out
    assert "ball10.off: 3 segments" in printed.err


def test_a_granularity_can_be_given_instead_of_a_number(
    url: str, meshes: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert submit(url, meshes[:1], tmp_path / "out", "--granularity", "1", "--results", "seg,json") == 0
    most = json.loads((tmp_path / "out" / "ball10.json").read_text())["max_segments"]
    assert len(set((tmp_path / "out" / "ball10.seg").read_text().split())) == most
    assert "ball10.off: granularity 1" in capsys.readouterr().err


def test_a_second_run_resumes_the_first(url: str, meshes: list[Path], tmp_path: Path) -> None:
    assert submit(url, meshes, tmp_path, "--results", "seg,png") == 0
    (tmp_path / "ball11.png").unlink()
    kept = (tmp_path / "ball10.seg").stat()
    with Client(url) as client:
        before = {job.id for job in client.jobs()}
        assert submit(url, meshes, tmp_path, "--results", "seg,png") == 0
        assert {job.id for job in client.jobs()} == before
        assert (tmp_path / "ball10.seg").stat().st_mtime_ns == kept.st_mtime_ns
        assert (tmp_path / "ball11.png").exists()
        assert submit(url, meshes, tmp_path, "--results", "seg", "--again") == 0
        assert len(list(client.jobs())) == 4


def test_deleted_jobs_are_submitted_again(url: str, meshes: list[Path], tmp_path: Path) -> None:
    assert submit(url, meshes, tmp_path / "first") == 0
    with Client(url) as client:
        for job in list(client.jobs()):
            client.delete(job.id)
    assert submit(url, meshes, tmp_path / "second") == 0


def test_a_failed_file_does_not_stop_the_others(
    url: str, meshes: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bad = tmp_path / "bad.off"
    bad.write_bytes(b"OFF\n1 1")
    assert submit(url, [bad, *meshes], tmp_path / "out") == 1
    error = capsys.readouterr().err
    assert "2 of 3 files" in error
    assert "bad.off: The job has no result" in error
    assert (tmp_path / "out" / "ball11.glb").exists()


def test_files_that_cannot_be_read_do_not_stop_the_others(
    url: str, meshes: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "empty").mkdir()
    files = [tmp_path / "missing.off", tmp_path / "empty", meshes[0]]
    assert submit(url, files, tmp_path / "out", "--results", "seg") == 1
    error = capsys.readouterr().err
    assert "1 of 3 files have their results" in error
    assert "(1 made, 0 kept, 2 failed)" in error
    assert "missing.off: No such file or directory" in error
    assert "empty: The folder 'empty' contains no mesh" in error
    assert results_in(tmp_path / "out") == ["ball10.seg"]


def test_errors_of_the_arguments_are_reported_before_anything_is_sent(
    url: str, meshes: list[Path], tmp_path: Path
) -> None:
    with pytest.raises(SystemExit) as stopped:
        submit(url, meshes, tmp_path, "--results", "mp3")
    assert stopped.value.code == 2
    assert not (tmp_path / "data" / "jobs").exists()


def test_a_server_that_does_not_answer_is_said_once(
    meshes: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("service.commands.submit._RETRIES", 0)
    assert submit("http://127.0.0.1:9", meshes, tmp_path / "out") == 2
    assert capsys.readouterr().err.count("is the server running?") == 1


def seconds(folder: Path) -> dict[str, int]:
    """When each result was written."""
    return {name: (folder / name).stat().st_mtime_ns for name in results_in(folder)}


def test_exactly_what_has_changed_is_made_again(
    url: str, meshes: list[Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    options = ["--results", "seg,json,zip"]
    assert submit(url, meshes, out, *options, "--segments", "3") == 0
    first = seconds(out)
    assert submit(url, meshes, out, *options, "--segments", "3") == 0
    assert seconds(out) == first
    assert "2 of 2 files have their results" in capsys.readouterr().out.splitlines()[-1]

    def changed(*now: str) -> set[str]:
        before = seconds(out)
        assert submit(url, meshes, out, *options, *now) == 0
        return {name for name, at in seconds(out).items() if at != before[name]}

    of_level = {f"ball{n}.{ending}" for n in (10, 11) for ending in ("seg", "zip")}
    assert changed("--segments", "4") == of_level  # the tree is the same at every level
    assert set((out / "ball10.seg").read_text().split()) == {"0", "1", "2", "3"}
    assert changed("--segments", "4", "--open") == {"ball10.zip", "ball11.zip"}
    assert changed("--segments", "4", "--open", "--set", "seed=1") == set(first)
    meshes[0].write_bytes(sphere(12))
    assert changed("--segments", "4", "--open", "--set", "seed=1") == {
        f"ball10.{one}" for one in ("seg", "json", "zip")
    }
    assert "(1 made, 1 kept, 0 failed)" in capsys.readouterr().out.splitlines()[-1]


def test_everything_is_made_again_by_another_version_of_the_server(
    url: str, meshes: list[Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert submit(url, meshes, tmp_path / "out", "--results", "seg") == 0
    first = seconds(tmp_path / "out")
    monkeypatch.setattr(Client, "version", lambda _: "99")
    assert submit(url, meshes, tmp_path / "out", "--results", "seg") == 0
    assert all(at != first[name] for name, at in seconds(tmp_path / "out").items())


def test_a_failure_is_tried_again(url: str, tmp_path: Path) -> None:
    bad = tmp_path / "bad.off"
    bad.write_bytes(b"OFF\n1 1")
    with Client(url) as client:
        for runs in (1, 2, 3):
            assert submit(url, [bad], tmp_path / "out") == 1
            assert len(list(client.jobs())) == runs


def test_a_damaged_record_only_costs_time(url: str, meshes: list[Path], tmp_path: Path) -> None:
    assert submit(url, meshes[:1], tmp_path / "out", "--results", "seg") == 0
    for content in (b"", b"[1]", b"\xff", b'{"made_from": 3}'):
        (tmp_path / "out" / RECORD).write_bytes(content)
        assert submit(url, meshes[:1], tmp_path / "out", "--results", "seg") == 0
    assert json.loads((tmp_path / "out" / RECORD).read_text())["made_from"].keys() == {"ball10.seg"}


def test_a_name_that_is_no_text_is_shown_escaped_and_sent(
    url: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = Path(os.fsdecode(os.fsencode(tmp_path) + b"/b\xe4ll.off"))
    path.write_bytes(sphere(10))
    assert submit(url, [path], tmp_path / "out", "--results", "seg") == 0
    assert "b\\xe4ll.off: " in capsys.readouterr().err
    with Client(url) as client:
        (job,) = client.jobs()
    assert job.document["input"]["file_name"] == "b\ufffdll.off"


def test_files_of_the_same_stem_do_not_overwrite_each_other(url: str, meshes: list[Path], tmp_path: Path) -> None:
    other = tmp_path / "ball10.txt"
    other.write_bytes(meshes[1].read_bytes())
    assert submit(url, [meshes[0], other], tmp_path / "out", "--results", "seg") == 0
    assert results_in(tmp_path / "out") == ["ball10.off.seg", "ball10.txt.seg"]


def test_the_structure_of_a_file_is_followed_and_limits_are_reported(
    url: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "two.obj"
    path.write_text(TWO_SQUARES)
    options = ["--structure", "groups", "--set", "max_segments=2", "--results", "seg"]
    assert submit(url, [path], tmp_path, *options) == 0
    assert len(set((tmp_path / "two.seg").read_text().split())) == 2
    assert "two.obj: 2 segments; The hierarchy ends with the 2 groups of the file" in capsys.readouterr().err


def test_the_whole_input_divided_by_part_is_a_result(url: str, meshes: list[Path], tmp_path: Path) -> None:
    assert submit(url, meshes[:1], tmp_path, "--results", "kept,glb") == 0
    assert b"original look" in (tmp_path / "ball10.kept.glb").read_bytes()
    assert b"original look" not in (tmp_path / "ball10.glb").read_bytes()


@pytest.mark.parametrize(("options", "is_closed"), [([], True), (["--open"], False)])
def test_parts_for_printing_are_closed_unless_they_are_to_be_open(
    url: str, meshes: list[Path], tmp_path: Path, options: list[str], is_closed: bool
) -> None:
    assert submit(url, meshes[:1], tmp_path, "--segments", "3", "--results", "seg,3mf,zip", *options) == 0
    parts = list(trimesh.load(tmp_path / "ball10.3mf").geometry.values())
    with zipfile.ZipFile(tmp_path / "ball10.zip") as archive:
        parts += [trimesh.load(io.BytesIO(archive.read(f"segment_{k}.stl")), file_type="stl") for k in range(3)]
    assert [part.is_watertight for part in parts] == [is_closed] * 6


def test_the_files_that_a_model_refers_to_are_sent_with_it(url: str, tmp_path: Path) -> None:
    asset = gltf_square()
    asset.document["buffers"] = [{"byteLength": len(asset.binary), "uri": "data/a%20b.bin"}]
    (tmp_path / "data").mkdir(exist_ok=True)
    (tmp_path / "data" / "a b.bin").write_bytes(asset.binary)
    (tmp_path / "scene.gltf").write_text(json.dumps(asset.document))
    for binary in (asset.binary, asset.binary + b"\0"):
        (tmp_path / "data" / "a b.bin").write_bytes(binary)
        assert submit(url, [tmp_path], tmp_path / "out", "--results", "seg") == 0
        (tmp_path / "out" / "scene.seg").unlink()
    with Client(url) as client:
        assert len(list(client.jobs())) == 2  # another buffer is another job
