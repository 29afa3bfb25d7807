"""Draws the pictures of the samples into static/: ``python viewer/sample_pictures.py`` at the top of the repository."""

from pathlib import Path

from segcore.io.picture import draw, write_png
from service.samples import SAMPLES, sample_shape

_SIZE = 224  # device pixels

for name in SAMPLES:
    shape = sample_shape(name)
    with (Path(__file__).parent / "static" / f"sample-{name}.png").open("wb") as target:
        write_png(target, draw(shape.mesh, shape.parts, _SIZE, azimuth=30, elevation=18))
