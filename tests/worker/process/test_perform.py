"""Running a job without a queue: the outcome is a result, or a failure with a reason."""

import gzip
import io
import json
from dataclasses import asdict
from pathlib import Path

import pytest

import segcore
from cleave.settings import Settings
from helpers.jobs import accepted, sphere
from segcore.io.result import read_result, write_result
from segcore.report import mesh_report
from worker.jobs.job import Canceled, Failed, Succeeded, now
from worker.jobs.store.store import JobStore
from worker.process.perform import perform

TETRAHEDRON = b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"


def ignore(stage: str, fraction: float) -> None:
    del stage, fraction


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(data_dir=tmp_path / "data", max_faces=10_000)


def test_the_result_is_that_of_segcore(store: JobStore, settings: Settings, tmp_path: Path) -> None:
    mesh_file = tmp_path / "mesh.off"
    mesh_file.write_bytes(sphere(20))
    job = accepted(store, mesh_file.read_bytes(), max_segments=9)
    perform(store, settings, job.id, ignore)
    outcome = store.records.outcome(job.id)
    assert isinstance(outcome, Succeeded)
    with store.results.open(job.id) as file:
        result = read_result(file)
    expected = segcore.segment(segcore.read_mesh(mesh_file), segcore.SegmentationParameters(max_segments=9))
    assert (result.hierarchy.labels(5) == expected.labels(5)).all()
    assert (outcome.faces, outcome.vertices) == (4 * 20 * 19, len(result.mesh.vertices))
    assert (outcome.max_segments, outcome.automatic_segments) == (expected.max_segments, expected.automatic_segments)
    assert (outcome.limit_reached, result.hierarchy.limit_reached) == (True, True)
    assert result.hierarchy.step.tolist() == expected.step.tolist()
    report = mesh_report(result.mesh)
    assert outcome.report is not None
    assert json.loads(json.dumps(asdict(report))) == outcome.report


def test_the_result_file_has_the_bytes_that_the_library_writes(store: JobStore, settings: Settings) -> None:
    job = accepted(store, sphere(20))
    perform(store, settings, job.id, ignore)
    mesh = segcore.read_mesh(io.BytesIO(sphere(20)), "off", appearance=True)
    expected = io.BytesIO()
    write_result(expected, mesh, segcore.segment(mesh))
    with store.results.open(job.id) as file:
        assert file.read() == expected.getvalue()


def test_the_appearance_in_the_file_is_kept(store: JobStore, settings: Settings) -> None:
    job = accepted(store, b"NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n")
    perform(store, settings, job.id, ignore)
    with store.results.open(job.id) as file:
        appearance = read_result(file).mesh.appearance
    assert appearance is not None
    assert appearance.normals.tolist() == [[0, 0, 1]] * 3


def test_a_second_run_writes_the_same_bytes_with_more_threads(store: JobStore, settings: Settings) -> None:
    contents = []
    for threads in (1, 2):
        job = accepted(store, sphere(12))
        perform(store, settings.model_copy(update={"job_threads": threads}), job.id, ignore)
        with store.results.open(job.id) as file:
            contents.append(file.read())
    assert contents[0] == contents[1]


def test_progress_increases_from_0_to_1(store: JobStore, settings: Settings) -> None:
    seen: list[tuple[str, float]] = []
    perform(store, settings, accepted(store, sphere(12)).id, lambda stage, fraction: seen.append((stage, fraction)))
    fractions = [fraction for _, fraction in seen]
    assert seen[0] == ("reading", 0.0)
    assert fractions == sorted(fractions)
    assert fractions[-1] == 1.0


@pytest.mark.parametrize(
    ("mesh", "parameters", "code"),
    [
        (b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", {}, "invalid_mesh"),
        (b"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", {}, "invalid_mesh"),
        (b"what is this", {}, "unsupported_format"),
        (sphere(60), {}, "limit_exceeded"),
        (TETRAHEDRON, {"max_segments": 0}, "invalid_parameters"),
    ],
)
def test_an_invalid_input_fails_at_the_first_attempt_with_a_reason(
    store: JobStore, settings: Settings, mesh: bytes, parameters: dict[str, object], code: str
) -> None:
    job = accepted(store, mesh, **parameters)
    perform(store, settings, job.id, ignore)
    outcome = store.records.outcome(job.id)
    assert isinstance(outcome, Failed)
    assert outcome.code == code
    assert outcome.message.endswith(".")
    assert str(settings.data_dir) not in outcome.message


def test_a_mesh_that_the_store_lost_is_a_failure_with_a_reason(
    store: JobStore, settings: Settings, tmp_path: Path
) -> None:
    job = accepted(store, TETRAHEDRON)
    (tmp_path / "data" / "jobs" / job.id / f"mesh-{job.sha256}").unlink()
    perform(store, settings, job.id, ignore)
    outcome = store.records.outcome(job.id)
    assert isinstance(outcome, Failed)
    assert outcome.code == "input_lost"


def test_a_job_with_an_outcome_is_not_run_again(store: JobStore, settings: Settings) -> None:
    job = accepted(store, TETRAHEDRON)
    store.finish(job.id, Canceled(finished_at=now()))
    perform(store, settings, job.id, lambda *_: pytest.fail("it was run"))
    assert isinstance(store.records.outcome(job.id), Canceled)


def test_a_job_that_is_deleted_while_it_runs_ends_without_an_error(store: JobStore, settings: Settings) -> None:
    job = accepted(store, TETRAHEDRON)
    perform(store, settings, job.id, lambda stage, _: store.delete(job.id) if stage == "reading" else None)
    assert store.records.job(job.id) is None


def test_an_unexpected_error_is_not_an_outcome(store: JobStore, settings: Settings) -> None:
    job = accepted(store, TETRAHEDRON)

    def fail(stage: str, fraction: float) -> None:
        raise ZeroDivisionError(f"{stage} {fraction}")

    with pytest.raises(ZeroDivisionError):
        perform(store, settings, job.id, fail)
    assert store.records.outcome(job.id) is None


@pytest.mark.parametrize("limit", ["max_uncompressed_bytes", "max_faces", "max_vertices"])
def test_every_limit_of_the_settings_is_applied_by_the_reader(store: JobStore, settings: Settings, limit: str) -> None:
    job = accepted(store, gzip.compress(sphere(12)))
    perform(store, settings.model_copy(update={limit: 100}), job.id, ignore)
    outcome = store.records.outcome(job.id)
    assert isinstance(outcome, Failed)
    assert outcome.code == "limit_exceeded"
    assert f"{limit} = 100" in outcome.message
