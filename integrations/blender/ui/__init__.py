"""Operators, panel and preferences."""
