"""Parts for printing, as a slicer sees them."""
