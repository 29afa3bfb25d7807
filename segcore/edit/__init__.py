"""Corrections of a segmentation by hand: the part around marked faces, and borders between parts."""
