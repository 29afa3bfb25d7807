"""Corrections by hand: the part around marked faces, borders between parts, and the operations of a person."""
