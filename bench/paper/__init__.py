"""Reproduces the evaluation of the paper that Cleave builds on: its methods, tables and figures.

Chahhou, Moumoun, El Far, Gadi, Segmentation of 3D meshes using p-spectral clustering, IEEE Transactions on Pattern
Analysis and Machine Intelligence 36, 2014, section 5.
"""
