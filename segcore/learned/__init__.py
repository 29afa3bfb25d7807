"""The models that were learned from people's segmentations."""
