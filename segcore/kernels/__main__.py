"""``python -m segcore.kernels``: compile all kernels into the cache; with ``--quiet``, silently and at low priority."""

import argparse
import sys

from segcore.kernels import compile_kernels

_NICENESS = 10  # of --quiet; set by hand


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m segcore.kernels", description=__doc__)
    parser.add_argument("--quiet", action="store_true")
    if parser.parse_args().quiet:
        compile_kernels(niceness=_NICENESS)
    else:
        compile_kernels(on_progress=lambda progress: sys.stdout.write(f"{progress}\n"))


if __name__ == "__main__":
    main()
