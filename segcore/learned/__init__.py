"""The models that were fitted to segmentations by people."""
