"""How the processes of Cleave log: lines on the standard error, which the supervisor or the container keeps."""

import logging


def configure_logging(level: str) -> None:
    logging.basicConfig(level=level.upper(), format="%(asctime)s %(levelname)-7s %(name)s: %(message)s")
