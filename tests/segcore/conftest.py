"""Hypothesis draws the same examples in every run, and does not time the first call of a compiled kernel."""

from hypothesis import settings

settings.register_profile("segcore", derandomize=True, deadline=None)
settings.load_profile("segcore")
