"""Files that are whole or absent, and what is left on the disk."""

import os
from pathlib import Path

import pytest

from worker.jobs.objects.durable import create_file, replace_file
from worker.jobs.store.spool import Spool


def files_below(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_a_write_that_fails_leaves_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "file"
    replace_file(path, lambda target: target.write(b"old"))

    def fail(_: object) -> None:
        raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space"):
        replace_file(path, fail)
    assert path.read_bytes() == b"old"
    assert files_below(tmp_path) == ["file"]


def test_a_file_is_created_once(tmp_path: Path) -> None:
    assert create_file(tmp_path / "file", b"first")
    assert not create_file(tmp_path / "file", b"second")
    assert (tmp_path / "file").read_bytes() == b"first"
    assert files_below(tmp_path) == ["file"]


def test_an_upload_whose_process_died_is_removed_when_nobody_touches_it(tmp_path: Path) -> None:
    spool = Spool(tmp_path)
    orphan = spool.begin_upload()
    orphan.write(b"half of a mesh")
    orphan.close()
    result = spool.result_file("0" * 32)
    result.write_bytes(b"half of a result")
    spool.remove_abandoned(untouched_s=3600)
    assert len(files_below(tmp_path)) == 2
    for path in (orphan.folder, orphan.path, result):
        os.utime(path, (0, 0))
    spool.remove_abandoned(untouched_s=3600)
    assert list(tmp_path.iterdir()) == []


def test_a_job_that_still_runs_keeps_its_folder_however_old_it_is(tmp_path: Path) -> None:
    spool = Spool(tmp_path)
    with spool.stage() as folder:
        (folder / "mesh").write_bytes(b"mesh")
        for path in (folder / "mesh", folder):
            os.utime(path, (0, 0))
        spool.remove_abandoned(untouched_s=3600)
        assert (folder / "mesh").exists()
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "stage-of-a-killed-process").mkdir()
    os.utime(tmp_path / "stage-of-a-killed-process", (0, 0))
    spool.remove_abandoned(untouched_s=3600)
    assert list(tmp_path.iterdir()) == []
