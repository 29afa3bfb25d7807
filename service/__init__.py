"""HTTP, the command line, and the supervisor that wires them to the workers."""
