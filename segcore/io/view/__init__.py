"""Pictures in which the parts have numbers, and what is seen at their pixels."""
