"""The cache of the kernels is writable and contains the kernels of the installation."""

import os
from pathlib import Path

import pytest

from service.host.kernel_cache import prepare_kernel_cache

VARIABLE = "NUMBA_CACHE_DIR"


@pytest.fixture
def shipped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The kernels of an installation that this user cannot write."""
    folder = tmp_path / "shipped"
    (folder / "segcore_1").mkdir(parents=True)
    (folder / "segcore_1" / "kernel.nbi").write_bytes(b"compiled")
    monkeypatch.setenv(VARIABLE, str(folder))
    writable = os.access
    monkeypatch.setattr(os, "access", lambda path, mode: not Path(path).is_relative_to(folder) and writable(path, mode))
    return folder


def chosen_cache(tmp_path: Path) -> Path:
    prepare_kernel_cache(lambda: tmp_path / "data")
    return Path(os.environ[VARIABLE])


def test_kernels_of_a_read_only_installation_are_copied_once(tmp_path: Path, shipped: Path) -> None:
    first = chosen_cache(tmp_path)
    assert (first / "segcore_1" / "kernel.nbi").read_bytes() == b"compiled"
    assert os.access(first, os.W_OK)
    (first / "segcore_1" / "more.nbi").write_bytes(b"compiled later")
    os.environ[VARIABLE] = str(shipped)
    assert chosen_cache(tmp_path) == first
    assert sorted(path.name for path in first.parent.iterdir()) == [first.name]


def test_other_kernels_get_another_copy(tmp_path: Path, shipped: Path) -> None:
    first = chosen_cache(tmp_path)
    (shipped / "segcore_1" / "kernel.nbi").write_bytes(b"compiled anew")
    os.environ[VARIABLE] = str(shipped)
    second = chosen_cache(tmp_path)
    assert second != first
    assert (second / "segcore_1" / "kernel.nbi").read_bytes() == b"compiled anew"


def test_a_writable_cache_is_used_as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    assert chosen_cache(tmp_path) == tmp_path
    assert not (tmp_path / "data").exists()


def test_a_read_only_installation_without_kernels_compiles_into_the_data_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(VARIABLE, "")
    monkeypatch.delenv(VARIABLE)
    monkeypatch.setattr(os, "access", lambda path, _: Path(path) == tmp_path)
    assert chosen_cache(tmp_path) == tmp_path / "data" / "kernels"
