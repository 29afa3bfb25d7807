"""The spool: files of processes that have died are removed, those of running jobs are kept."""

import os
from pathlib import Path

from worker.jobs.store.spool import Spool


def files_below(folder: Path) -> list[str]:
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


def test_uploads_and_results_that_are_no_longer_written_are_removed(tmp_path: Path) -> None:
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


def test_the_folder_of_a_running_job_is_kept_however_old_it_is(tmp_path: Path) -> None:
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
