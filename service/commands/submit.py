"""`cleave submit`: segment many files on a server and save their results in a folder."""

import argparse
import os
import sys
import threading
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from cleave.client import Client
from cleave.client.errors import ClientError
from segcore.errors import CleaveError
from segcore.io import model_in_folder
from service.commands.arguments import add_coordinates, add_level, add_parameters, add_structure
from service.commands.console import ProgressBoard, say, say_beside
from service.commands.server_results import DEFAULT_RESULTS, RESULTS, result_names
from service.commands.submission import Ending, Session, Submission, submit_file
from service.commands.submit_record import SubmitRecord

_DEFAULT_SERVER = "http://127.0.0.1:8000"
_SOME_FAILED, _NOTHING_TRIED = 1, 2  # exit statuses
_CONCURRENT_FILES = 4  # in upload or with a job that is waited for; set by hand, so that a few workers are kept busy
_RETRIES = 8  # of a request; the client waits about a minute between them, enough for a server that is restarted


class SomeFailed(Exception):  # noqa: N818
    """Some files have no results; the message contains how many and why."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = (
        "Submit mesh files to a service, with the files in their folders that they refer to (materials, buffers, "
        "pictures), and save their results. A second run resumes an interrupted one. If the "
        "service requires an API key, set it in the environment variable CLEAVE_API_KEY."
    )
    parser.add_argument("files", type=Path, nargs="+", metavar="FILE", help="mesh files, or folders with one")
    parser.add_argument("--server", default=_DEFAULT_SERVER, metavar="URL", help="of the service (%(default)s)")
    add_coordinates(parser)
    add_level(parser, "chosen by each mesh")
    add_structure(parser)
    add_parameters(parser, "max_segments=100")
    parser.add_argument(
        "--results",
        type=result_names,
        default=DEFAULT_RESULTS,
        metavar="LIST",
        help=f"what to save, separated by commas: {', '.join(RESULTS)} ({','.join(DEFAULT_RESULTS)})",
    )
    parser.add_argument(
        "--open", action="store_true", help="3mf and zip: save the parts as they are, not closed at their cuts"
    )
    parser.add_argument("-o", "--output", type=Path, default=Path(), metavar="DIR", help="folder of the results (here)")
    parser.add_argument("--again", action="store_true", help="compute and save again what was done before")


def run(choices: argparse.Namespace) -> int:
    """Submit the files, wait for their jobs, save their results and print a summary.

    A result that was made from the same file, with the same options, by the same version of the server is kept. The key
    of a job is derived from the file, the parameters and that version, so a second run finds the jobs of the first;
    those that failed are tried again. A file that cannot be read, or has no result, does not end the run.

    Raises
    ------
    OSError
        If the folder of the results cannot be made.
    """
    try:
        say(_submit_files(choices, os.environ.get("CLEAVE_API_KEY")))
    except SomeFailed as failed:
        say_beside(f"cleave: {failed}")
        return _SOME_FAILED
    except ClientError as error:
        say_beside(f"cleave: {error}")
        return _NOTHING_TRIED
    return 0


def _submit_files(choices: argparse.Namespace, api_key: str | None) -> str:
    """Submit all files and return a summary; raise SomeFailed if some have no results."""
    submissions = _submissions(choices)
    choices.output.mkdir(parents=True, exist_ok=True)
    stopping = threading.Event()
    with (
        ProgressBoard(sys.stderr) as board,
        Client(choices.server, api_key, retries=_RETRIES) as client,
        ThreadPoolExecutor(_CONCURRENT_FILES) as pool,
    ):
        session = Session(client, board, SubmitRecord(choices.output), stopping, client.version())
        futures = [pool.submit(submit_file, session, submission) for submission in submissions]
        try:
            endings = [future.result() for future in futures]
        except BaseException:
            stopping.set()
            pool.shutdown(cancel_futures=True)
            raise
    return _summary(endings, choices.output)


def _summary(endings: Sequence[tuple[Ending | None, str]], folder: Path) -> str:
    """Return the numbers of files by their endings; raise SomeFailed with the reasons if some failed."""
    failed = [text for ending, text in endings if ending is None]
    counts = Counter(ending for ending, _ in endings)
    done = f"{len(endings) - len(failed)} of {len(endings)} files have their results in {folder}"
    parts = f"{counts['made']} made, {counts['kept']} kept, {len(failed)} failed"
    if failed:
        raise SomeFailed(f"{done} ({parts}): {'; '.join(failed)}")
    return f"{done} ({parts})"


def _submissions(choices: argparse.Namespace) -> list[Submission]:
    names = _result_names([_mesh_of(path) for path in choices.files])
    parameters = dict(choices.parameters) | ({"structure": choices.structure} if choices.structure else {})
    return [
        Submission(
            path,
            name,
            parameters=parameters,
            unit=choices.unit,
            up=choices.up,
            segments=choices.segments,
            granularity=choices.granularity,
            results=choices.results,
            folder=choices.output,
            again=choices.again,
            open_parts=choices.open,
        )
        for path, name in zip(choices.files, names, strict=True)
    ]


def _mesh_of(path: Path) -> Path:
    """Return the mesh file in a folder; the path itself if it is no folder, or its one mesh cannot be told."""
    try:
        return model_in_folder(path)
    except (OSError, CleaveError):
        return path


def _result_names(files: Sequence[Path]) -> list[str]:
    """Return the stem of every file, or the full names if two files have the same stem."""
    stems = [path.stem for path in files]
    names = stems if len(set(stems)) == len(stems) else [path.name for path in files]
    if len(set(names)) < len(names):
        raise SomeFailed("Two files have the same name: submit them into different folders.")
    return names
