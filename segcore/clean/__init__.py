"""A mesh becomes a surface that can be measured and cut: welded, oriented, its edges found."""
