"""Robots, as MuJoCo sees them."""
