"""Answers: results of a job in the form, at the level and in the range that a client asks for."""
