"""`cleave submit` on the command line."""

import argparse
import os
import sys
from collections.abc import Callable
from pathlib import Path

from service.commands.file_arguments import add_fineness
from service.commands.saved_results import RESULTS

SOME_FAILED = 1  # exit status

_DEFAULT_SERVER = "http://127.0.0.1:8000"


def add_submit(submit: argparse.ArgumentParser, parameter: Callable[[str], tuple[str, object]]) -> None:
    """Describe the command; ``parameter`` reads NAME=VALUE."""
    submit.add_argument("files", type=Path, nargs="+", metavar="FILE", help="mesh files")
    submit.add_argument("--server", default=_DEFAULT_SERVER, metavar="URL", help="of the service (%(default)s)")
    add_fineness(submit, "chosen by each mesh")
    submit.add_argument(
        "--set",
        type=parameter,
        action="append",
        default=[],
        dest="parameters",
        metavar="NAME=VALUE",
        help="a parameter of the method, such as max_segments=100; may be given again",
    )
    submit.add_argument(
        "--results",
        type=_results,
        default=("seg", "json", "glb"),
        metavar="LIST",
        help=f"what to save, with commas between: {', '.join(RESULTS)} (seg,json,glb)",
    )
    submit.add_argument("-o", "--output", type=Path, default=Path(), metavar="DIR", help="folder of the results (here)")
    submit.add_argument("--again", action="store_true", help="compute and save what was done before")
    submit.set_defaults(run=_submit)


def _submit(choices: argparse.Namespace) -> int:
    from service.commands.submit import SomeFailed, SubmitRequest, submit_files

    request = SubmitRequest(
        files=choices.files,
        server=choices.server,
        api_key=os.environ.get("CLEAVE_API_KEY"),
        segments=choices.segments,
        granularity=choices.granularity,
        parameters=dict(choices.parameters),
        results=choices.results,
        folder=choices.output,
        again=choices.again,
    )
    try:
        summary = submit_files(request)
    except SomeFailed as failed:
        print(f"cleave: {failed}", file=sys.stderr)
        return SOME_FAILED
    print("\n".join(summary), flush=True)
    return 0


def _results(text: str) -> tuple[str, ...]:
    chosen = tuple(part.strip() for part in text.split(",") if part.strip())
    unknown = [part for part in chosen if part not in RESULTS]
    if unknown or not chosen:
        raise argparse.ArgumentTypeError(f"results are {', '.join(RESULTS)}, not {text!r}")
    return chosen
