"""Kernels: functions that numba compiles, and the cache in which it keeps them."""
