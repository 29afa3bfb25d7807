"""The methods that the paper's evaluation compares with."""

from importlib.metadata import PackageNotFoundError
from pathlib import Path

import numpy as np
import pytest

from bench.errors import BenchmarkError
from bench.peers import PEERS
from bench.peers.cgal import CgalSdf, Clustering, nearest_clustering, read_clusterings
from bench.peers.kmeans import KMeans, weighted_kmeans
from bench.peers.method import MethodFailed
from bench.peers.pieces import keep_largest_pieces
from bench.peers.vhacd import VHacd, distance_to_hull
from bench.princeton.surface import Surface
from helpers.meshes import pieces_of_labels
from helpers.strips import cut_at, strip
from segcore.shapes import box, burr, dumbbell


def test_k_means_ends_where_every_point_is_nearest_to_the_weighted_mean_of_its_cluster() -> None:
    rng = np.random.default_rng(5)
    points, weight = rng.normal(size=(400, 3)), rng.uniform(0.1, 3.0, 400)
    cluster = weighted_kmeans(points, weight, 6)
    means = np.array([np.average(points[cluster == c], axis=0, weights=weight[cluster == c]) for c in range(6)])
    distance = np.linalg.norm(points[:, None] - means, axis=2)
    assert np.array_equal(distance.argmin(axis=1), cluster)


def test_k_means_tells_heaps_apart_whatever_they_weigh() -> None:
    rng = np.random.default_rng(5)
    heap = np.repeat(np.arange(4), (50, 5, 200, 1))
    points = rng.normal(size=(len(heap), 3)) + 100 * np.eye(4, 3)[heap]
    cluster = weighted_kmeans(points, rng.uniform(0.1, 3.0, len(heap)), 4)
    assert len(np.unique(heap * 4 + cluster)) == len(np.unique(cluster)) == 4


def test_k_means_makes_as_many_connected_segments_as_asked() -> None:
    mesh = burr(subdivisions=3).mesh
    for segments in (1, 2, 7):
        labels = KMeans()(mesh, segments).labels
        assert len(np.unique(labels)) == segments
        assert pieces_of_labels(mesh, labels) == segments


def test_a_piece_apart_from_its_cluster_joins_the_longest_border() -> None:
    # Three rows: the stray square of cluster 0 in the middle of row 1 has cluster 1 on three sides, 2 on one.
    columns, rows = 5, 3
    vertices, faces = strip(columns, rows)
    square = np.ones((columns, rows), dtype=np.int64)
    square[:, 2] = 2
    square[0] = 0
    square[3, 1] = 0
    expected = square.copy()
    expected[3, 1] = 1
    cleaned = keep_largest_pieces(vertices, Surface.from_mesh(vertices, faces), np.repeat(square.ravel(), 2))
    assert np.array_equal(cleaned, np.repeat(expected.ravel(), 2))


def test_pieces_between_stray_pieces_join_after_them() -> None:
    # Clusters 0 and 1 keep the pieces at the front. The stray columns 7 and 9 touch 1 and 2; column 8 only these two.
    labels = np.array([0, 0, 0, 0, 1, 1, 1, 0, 1, 0, 2, 2])
    vertices, faces = strip(len(labels))
    cleaned = keep_largest_pieces(vertices, Surface.from_mesh(vertices, faces), np.repeat(labels, 2))
    assert np.array_equal(cleaned[::2], [0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2])


def test_connected_clusters_stay_as_they_are() -> None:
    labels = cut_at(12, 4, 9)
    vertices, faces = strip(12)
    assert np.array_equal(keep_largest_pieces(vertices, Surface.from_mesh(vertices, faces), labels), labels)


def test_the_distance_to_a_hull_is_the_one_to_a_box_however_its_faces_are_turned() -> None:
    mesh = box((2, 2, 2))
    points = np.array([[0, 0, 0], [0.75, 0, 0.1], [1, 0.2, 0.3], [0.5, 0, -4]])
    faces = mesh.faces.copy()
    faces[::2] = faces[::2, ::-1]
    assert np.allclose(distance_to_hull(points, mesh.vertices, faces), [-1, -0.25, 0, 3])


def test_v_hacd_gives_every_face_to_the_hull_nearest_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    # The lower and the upper ball of a dumbbell, as hulls that overlap in the neck.
    shape = dumbbell(rings=24, around=16)
    hulls = [box((2, 2, 3.2), (0, 0, side * 1.5)) for side in (-1, 1)]
    parts = [{"vertices": hull.vertices, "faces": hull.faces} for hull in hulls]
    monkeypatch.setattr("trimesh.decomposition.convex_decomposition", lambda *_, **__: parts)
    labels = VHacd()(shape.mesh, 2).labels
    assert np.array_equal(labels, (shape.mesh.corners[:, :, 2].mean(axis=1) > 0).astype(np.int32))


def test_v_hacd_without_a_part_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("trimesh.decomposition.convex_decomposition", lambda *_, **__: [])
    with pytest.raises(MethodFailed, match="no part"):
        VHacd()(box(), 2)


def test_v_hacd_that_is_not_installed_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> str:
        raise PackageNotFoundError(name)

    monkeypatch.setattr("bench.peers.vhacd.version", missing)
    with pytest.raises(BenchmarkError, match="pip install vhacdx"):
        VHacd().prepare()


def clustering(clusters: int, segments: int) -> Clustering:
    return Clustering(clusters, 0.0, np.arange(30, dtype=np.int32) % segments)


def test_the_clustering_nearest_to_the_given_number_is_taken() -> None:
    clusterings = [clustering(2, 1), clustering(3, 6), clustering(4, 9), clustering(5, 12), clustering(8, 6)]
    assert nearest_clustering(clusterings, 12).clusters == 5
    assert nearest_clustering(clusterings, 2).clusters == 2
    # As near as each other: the one nearest to CGAL's own number of clusters.
    assert nearest_clustering(clusterings, 6).clusters == 3
    assert nearest_clustering(clusterings, 10).clusters == 4


def test_the_time_of_cgal_is_that_of_the_clustering_taken(tmp_path: Path) -> None:
    answering(tmp_path, "echo 2.5; echo 2 0.25 0 0 0 0 1 1 1 1 1 1 1 1; echo 3 0.5 0 0 0 0 1 1 1 1 2 2 2 2")
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
def test_cgal_failing_on_a_mesh_is_one_sentence(tmp_path: Path, script: str, message: str) -> None:
    answering(tmp_path, script)
    with pytest.raises(MethodFailed, match=message):
        CgalSdf(tmp_path)(box(), 2)


def test_the_labels_of_every_clustering_are_read() -> None:
    sdf_s, (two, three) = read_clusterings("1.5\n2 0.5 0 1 1\n3 0.25 2 1 0\n", 3)
    assert (sdf_s, two.clusters, two.cpu_s, two.segments) == (1.5, 2, 0.5, 2)
    assert (three.clusters, three.labels.tolist()) == (3, [2, 1, 0])


def test_cgal_that_cannot_be_built_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BenchmarkError, match=r"needs g\+\+"):
        CgalSdf(tmp_path).prepare()
    compiler = tmp_path / "g++"
    compiler.write_text("#!/bin/sh\necho 'fatal error: CGAL/Surface_mesh.h: No such file' >&2\nexit 1\n")
    compiler.chmod(0o755)
    with pytest.raises(BenchmarkError, match=r"No such file.*libcgal-dev"):
        CgalSdf(tmp_path).prepare()
    assert [path.name for path in tmp_path.iterdir()] == ["g++"]


def test_a_program_that_is_there_is_not_built_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answering(tmp_path, "true")
    monkeypatch.setenv("PATH", "")
    CgalSdf(tmp_path).prepare()


def test_every_peer_is_listed_under_its_key(tmp_path: Path) -> None:
    assert {name: make(tmp_path).key for name, make in PEERS.items()} == {name: name for name in PEERS}


def answering(folder: Path, script: str) -> None:
    """Put a shell script where the program of CgalSdf is kept; it reads the mesh as the program does."""
    program = CgalSdf(folder).program
    program.write_text(f"#!/bin/sh\ncat > /dev/null\n{script}\n")
    program.chmod(0o755)
