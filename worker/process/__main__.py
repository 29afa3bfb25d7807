"""Run the worker process: ``python -m worker.process small|large``."""

from worker.process.process import main

main()
