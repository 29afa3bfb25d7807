"""What ``python -m bench train`` learns from the people of the benchmark."""
