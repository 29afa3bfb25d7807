"""Digests of segmentations and written files, to show that a change keeps results equal to the byte."""
