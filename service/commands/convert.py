"""`cleave convert`: a .cleave file in, the same segmentation in other formats out."""

from collections.abc import Sequence
from pathlib import Path

from segcore.io.result import read_result
from segcore.levels import Fineness
from service.commands.outputs import OutputOptions, check_outputs, write_model


def convert_file(result: Path, fineness: Fineness, outputs: Sequence[Path], options: OutputOptions) -> list[str]:
    """Write the files, and sum up in a few lines what is in them.

    Raises
    ------
    CleaveError
        Where the file is damaged, or there is no such level.
    OSError
        Where a file cannot be read or written.
    """
    check_outputs(outputs)
    opened = read_result(result)
    count = fineness.segments_of(opened.hierarchy)
    for path in outputs:
        write_model(path, opened.mesh, opened.hierarchy, count, options)
    chosen = "chosen automatically" if fineness.is_automatic else "as asked"
    return [
        f"{count} segments, {chosen}; 1 to {opened.hierarchy.max_segments} are possible",
        *(f"wrote {path}" for path in outputs),
    ]
