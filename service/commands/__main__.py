"""Run the command `cleave` as ``python -m service.commands``."""

from service.commands.main import command

if __name__ == "__main__":
    command()
