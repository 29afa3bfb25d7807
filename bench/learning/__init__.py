"""Learns models of boundaries and splits from people's segmentations, for ``python -m bench train``."""
