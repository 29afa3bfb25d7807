"""Time and memory of one segmentation over the number of faces."""
