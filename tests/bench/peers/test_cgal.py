"""CGAL's segmentation, with a shell script in place of its program."""

from pathlib import Path

import numpy as np
import pytest

from bench.errors import BenchmarkError
from bench.peers.cgal import CgalSdf, Clustering, Clusterings, read_clusterings
from bench.peers.method import MethodFailed
from segcore.shapes import box


def install_script(folder: Path, script: str) -> None:
    """Replace the program of CgalSdf by a shell script, which reads the mesh first."""
    program = CgalSdf(folder).program
    program.write_text(f"#!/bin/sh\ncat > /dev/null\n{script}\n")
    program.chmod(0o755)


def clustering(clusters: int, segments: int) -> Clustering:
    return Clustering(clusters, 0.0, np.arange(30, dtype=np.int32) % segments)


def test_the_clustering_nearest_to_the_given_number_is_used() -> None:
    each = (clustering(2, 1), clustering(3, 6), clustering(4, 9), clustering(5, 12), clustering(8, 6))
    clusterings = Clusterings(0.0, each)
    assert clusterings.nearest(12).clusters == 5
    assert clusterings.nearest(2).clusters == 2
    # Of two with the same number of segments, the one nearest to CGAL's default number of clusters.
    assert clusterings.nearest(6).clusters == 3
    assert clusterings.nearest(10).clusters == 4


def test_the_time_is_that_of_the_clustering_in_use(tmp_path: Path) -> None:
    install_script(tmp_path, "echo 2.5; echo 2 0.25 0 0 0 0 1 1 1 1 1 1 1 1; echo 3 0.5 0 0 0 0 1 1 1 1 2 2 2 2")
    outcome = CgalSdf(tmp_path)(box(), 2)
    assert outcome.cpu_s == 2.75
    assert outcome.labels.tolist() == [0] * 4 + [1] * 8
    assert CgalSdf(tmp_path)(box(), 3).cpu_s == 3.0


@pytest.mark.parametrize(
    ("script", "message"),
    [
        ("echo the surface is not an oriented manifold >&2; exit 1", "not an oriented manifold"),
        ("kill -SEGV $$", "SIGSEGV"),
        ("exit 3", "status 3"),
        ("echo 1; echo 2 0.1 0 0 0", "one label for every face"),
        ("echo 1", "one label for every face"),
        ("true", "cannot be read"),
        ("echo 1; echo 2 0.1 a", "cannot be read"),
    ],
)
def test_a_failure_on_a_mesh_is_one_sentence(tmp_path: Path, script: str, message: str) -> None:
    install_script(tmp_path, script)
    with pytest.raises(MethodFailed, match=message):
        CgalSdf(tmp_path)(box(), 2)


def test_the_labels_of_every_clustering_are_read() -> None:
    clusterings = read_clusterings("1.5\n2 0.5 0 1 1\n3 0.25 2 1 0\n", 3)
    two, three = clusterings.each
    assert (clusterings.sdf_s, two.clusters, two.cpu_s, two.segments) == (1.5, 2, 0.5, 2)
    assert (three.clusters, three.labels.tolist()) == (3, [2, 1, 0])


def test_a_failed_build_is_an_error_with_the_remedy(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BenchmarkError, match=r"needs g\+\+"):
        CgalSdf(tmp_path).prepare()
    compiler = tmp_path / "g++"
    compiler.write_text("#!/bin/sh\necho 'fatal error: CGAL/Surface_mesh.h: No such file' >&2\nexit 1\n")
    compiler.chmod(0o755)
    with pytest.raises(BenchmarkError, match=r"No such file.*libcgal-dev"):
        CgalSdf(tmp_path).prepare()
    assert [path.name for path in tmp_path.iterdir()] == ["g++"]


def test_an_existing_program_is_not_built_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install_script(tmp_path, "true")
    monkeypatch.setenv("PATH", "")
    CgalSdf(tmp_path).prepare()
