"""A day of a small team with an installation behind a proxy: what must be true of it in the evening."""
