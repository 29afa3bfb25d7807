"""How long commands and the service take to start, with and without compiled kernels."""
