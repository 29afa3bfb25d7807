"""`cleave key`: make an API key."""

import argparse

from cleave.settings import InvalidSettings
from service.commands.console import say
from service.keys import is_owner_name, key_digest, new_key


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.description = "Make an API key. The key is printed once and stored nowhere."
    parser.add_argument("name", metavar="NAME", help="owner of the key: a-z, 0-9 and dashes")


def run(choices: argparse.Namespace) -> None:
    """Print a new key for its owner, and the entry for the settings, which has only its digest."""
    if not is_owner_name(choices.name):
        raise InvalidSettings("The name of a key must have 1 to 32 characters of a-z, 0-9 and dashes.")
    key = new_key()
    say(f"key    {key}")
    say(f"entry  {choices.name}:{key_digest(key)}")
    say(f"Give the key to {choices.name}, and add the entry to CLEAVE_API_KEYS_FILE.")
