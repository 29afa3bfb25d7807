"""The checks of `cleave doctor`: problems of an installation, and how to fix them."""
