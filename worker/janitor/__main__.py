"""Run the janitor: ``python -m worker.janitor``."""

from worker.janitor.janitor import main

main()
