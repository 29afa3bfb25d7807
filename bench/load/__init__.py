"""The service under load: `python -m bench load` and `python -m bench throughput`."""
