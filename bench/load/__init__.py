"""How the service bears load; `python -m bench.load` runs everything and prints a table."""
