"""Pictures for pages: the same with fewer colours, which takes a third of the space."""

import shutil
from pathlib import Path

from PIL import Image

LARGEST = 140_000  # bytes of a picture that is taken as it is: pages load quickly
COLOURS = 256  # of a palette, the most that PNG has
ROUNDS = 3  # of k-means over the palette: without, pure colours are lost


def smaller_png(source: Path, target: Path) -> Path:
    """Write a PNG that is small: as it is, or where it is too large with a palette.

    Args:
        source: Any PNG.
        target: Where the small one is written.
    """
    if source.stat().st_size <= LARGEST:
        shutil.copyfile(source, target)
        return target
    with Image.open(source) as image:
        small = image.convert("RGB").quantize(COLOURS, kmeans=ROUNDS, dither=Image.Dither.NONE)
    small.save(target, optimize=True)
    return target
