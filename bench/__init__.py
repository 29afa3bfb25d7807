"""Benchmarks of Cleave: the quality of its segmentations, its speed, and the service under load and faults.

``python -m bench`` lists the commands; each is one module of ``bench.commands``.
"""
