"""Parts that were edited, as bytes and as members of a ``.cleave`` file."""
