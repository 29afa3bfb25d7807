"""Durable writes: after a crash a file is complete or absent."""

import errno
import os
import secrets
from collections.abc import Callable
from pathlib import Path
from typing import BinaryIO

TEMPORARY_SUFFIX = ".tmp"


def is_disk_full(error: OSError) -> bool:
    return error.errno in (errno.ENOSPC, errno.EDQUOT)


def replace_file(path: Path, write: Callable[[BinaryIO], object], *, durable: bool = True) -> None:
    """Write or replace a file so that a reader sees either the old bytes or all of the new ones.

    If it is not ``durable``, the file may be empty after a crash of the machine.
    """
    temporary = _write_temporary(path, write, durable=durable)
    try:
        os.replace(temporary, path)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    if durable:
        sync_folder(path.parent)


def create_file(path: Path, data: bytes, *, durable: bool = True) -> bool:
    """Write a file unless it exists; return True for the one writer that has created it.

    If it is not ``durable``, it may be absent after a crash of the machine, but never incomplete.
    """
    temporary = _write_temporary(path, lambda target: target.write(data))
    try:
        os.link(temporary, path)
    except FileExistsError:
        return False
    finally:
        temporary.unlink(missing_ok=True)
    if durable:
        sync_folder(path.parent)
    return True


def link_file(source: Path, path: Path) -> None:
    """Write or replace a file by another name of the same bytes."""
    temporary = path.with_name(_temporary_name(path))
    os.link(source, temporary)
    try:
        os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)  # os.replace does nothing if both are names of the same file
    sync_folder(path.parent)


def sync_file(file: BinaryIO) -> None:
    file.flush()
    os.fsync(file.fileno())


def sync_path(path: Path) -> None:
    """Make a file durable that has been written and closed."""
    with path.open("rb") as file:
        os.fsync(file.fileno())


def sync_folder(folder: Path) -> None:
    """Make the names in a folder durable."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _temporary_name(path: Path) -> str:
    return f".{path.name}.{secrets.token_hex(8)}{TEMPORARY_SUFFIX}"


def _write_temporary(path: Path, write: Callable[[BinaryIO], object], *, durable: bool = True) -> Path:
    temporary = path.with_name(_temporary_name(path))
    try:
        with temporary.open("xb") as file:
            write(file)
            if durable:
                sync_file(file)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    return temporary
