"""A soak test: processes of an installation are killed at random, and its results compared with those without kills."""
