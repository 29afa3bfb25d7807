"""Checks that outputs which keep everything of their input look and move as the input does."""
