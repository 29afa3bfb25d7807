"""A store of very many jobs, and what its operations cost."""
