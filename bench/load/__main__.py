"""`python -m bench.load [NAME ...]`: another name of `python -m bench load`."""

import sys

from bench.__main__ import main

if __name__ == "__main__":
    sys.exit(main(["load", *sys.argv[1:]]))
