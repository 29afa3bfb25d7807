"""Who may send requests, and the headers that protect the answers."""
