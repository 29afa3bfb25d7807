"""`cleave doctor`: whether an installation is set up so that it keeps its promises, and what to do where it is not."""
