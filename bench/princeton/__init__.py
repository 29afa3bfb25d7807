"""The Princeton Segmentation Benchmark: data, metrics and reports."""
