"""Types of arguments that several commands take."""

import argparse
import json


def parameter(text: str) -> tuple[str, object]:
    """Return a name and a value, which is parsed as JSON if possible (numbers, true, null) and a word otherwise.

    Raises
    ------
    ArgumentTypeError
        If the text is not KEY=VALUE.
    """
    name, equals, value = text.partition("=")
    if not name or not equals:
        raise argparse.ArgumentTypeError(f"a parameter is KEY=VALUE, not {text!r}")
    try:
        return name, json.loads(value)
    except ValueError:
        return name, value
