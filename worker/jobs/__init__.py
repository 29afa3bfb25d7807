"""Jobs, the store that keeps them, and the queue in which they wait."""
