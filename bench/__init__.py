"""Benchmarks of Cleave: how good its segmentations are, measured against people's.

``python -m bench`` lists the commands; each is one module of ``bench.commands``.
"""
