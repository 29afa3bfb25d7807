"""What the methods of a comparison share."""

from pathlib import Path

from bench.peers import PEERS
from bench.peers.method import source_digest


def test_the_digest_of_sources_changes_with_any_of_them(tmp_path: Path) -> None:
    for name in ("a.py", "b.py", "notes.txt"):
        (tmp_path / name).write_text(name)
    before = source_digest(tmp_path)
    (tmp_path / "notes.txt").write_text("changed")
    assert source_digest(tmp_path) == before
    (tmp_path / "b.py").write_text("changed")
    assert source_digest(tmp_path) != before
    assert source_digest(tmp_path / "a.py") != source_digest(tmp_path / "b.py")


def test_every_peer_is_listed_under_its_key(tmp_path: Path) -> None:
    assert {name: make(tmp_path).key for name, make in PEERS.items()} == {name: name for name in PEERS}
