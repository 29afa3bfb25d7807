"""Forms with several files, as pieces that are streamed."""

import hashlib
from collections.abc import Mapping
from pathlib import Path


def form_of(files: Mapping[str, Path | bytes], seed: str) -> tuple[str, list[Path | bytes]]:
    """Return the content type and the pieces of a form with a field ``mesh`` for each file.

    Parameters
    ----------
    files : files and bytes, by their names in the form.
    seed : the boundary is derived from it, so that a repeated request is the same.
    """
    boundary = f"cleave-{hashlib.sha256(seed.encode()).hexdigest()[:40]}"
    pieces: list[Path | bytes] = []
    for name, content in files.items():
        quoted = name.replace('"', "%22").replace("\r", "%0D").replace("\n", "%0A")
        head = f'--{boundary}\r\nContent-Disposition: form-data; name="mesh"; filename="{quoted}"\r\n\r\n'
        pieces += [head.encode("utf-8", "replace"), content, b"\r\n"]
    pieces.append(f"--{boundary}--\r\n".encode())
    return f"multipart/form-data; boundary={boundary}", pieces
