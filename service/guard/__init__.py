"""Who may send requests, and middleware that protects requests and responses."""
