"""The small pictures of tests/peers/images, half float: the same bytes each time they are made.

Called by metrics.py --write, in its virtual environment.
"""

import numpy
import OpenEXR


def hashed(shape, seed):
    """Numbers in 0..1 that look random: a hash of each index (the finaliser of MurmurHash3)."""
    x = numpy.arange(numpy.prod(shape), dtype=numpy.uint64) + numpy.uint64(seed << 32)
    for factor in (0xFF51AFD7ED558CCD, 0xC4CEB9FE1A85EC53):
        x = (x ^ (x >> numpy.uint64(33))) * numpy.uint64(factor)
    x ^= x >> numpy.uint64(33)
    return (x >> numpy.uint64(40)).reshape(shape) / 2.0**24


def scene(width, height):
    """A gradient of colors, a dark half, two highlights far above 1 and a grid of fine lines."""
    x, y = numpy.meshgrid(numpy.arange(width) / width, numpy.arange(height) / height)
    picture = numpy.stack([0.1 + 0.8 * x, 0.3 + 0.4 * y, 0.9 - 0.7 * x * y], -1)
    picture[y > 0.6] *= 0.08
    for (cx, cy, size, light) in ((0.3, 0.3, 0.06, 40.0), (0.75, 0.7, 0.03, 9.0)):
        spot = numpy.exp(-((x - cx) ** 2 + (y - cy) ** 2) / size**2)
        picture += light * spot[..., None] * numpy.array([1.0, 0.9, 0.7])
    lines = (x > 0.6) & (y < 0.4) & (numpy.arange(width) % 3 == 0)
    picture[lines] *= 0.5
    return picture


def noisy(picture, seed, amount):
    return picture * (1 + amount * (2 * hashed(picture.shape, seed) - 1))


def blurred(picture):
    rows = (numpy.roll(picture, 1, 0) + 2 * picture + numpy.roll(picture, -1, 0)) / 4
    return (numpy.roll(rows, 1, 1) + 2 * rows + numpy.roll(rows, -1, 1)) / 4


def firefly(picture):
    changed = picture.copy()
    changed[11, 21] = [9000.0, 7000.0, 5000.0]
    return changed


def pictures():
    base = scene(48, 40)
    gray = 0.4 + 0.02 * hashed((40, 48, 1), 5) * numpy.ones(3)
    negative = base - 0.2 * (hashed(base.shape, 6) > 0.8)
    result = {
        "base": base,
        "noise": noisy(base, 1, 0.4),
        "blur": blurred(base),
        "firefly": firefly(base),
        "brighter": base * 1.01,
        "gray": gray,
        "gray-tinted": gray * numpy.array([1.03, 1.0, 0.97]),
        "negative": negative,
    }
    # Smaller than a window of SSIM, and larger than a tile of 128 pixels, both ways.
    for width, height in ((17, 13), (7, 40), (1, 1), (140, 20), (20, 140)):
        reference = scene(width, height)
        result[f"{width}x{height}"] = reference
        result[f"{width}x{height}-noise"] = noisy(reference, width, 0.3)
    return result


def write(folder):
    for name, picture in pictures().items():
        channels = {c: picture[..., i].astype(numpy.float16) for i, c in enumerate("RGB")}
        header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
        OpenEXR.File(header, channels).write(str(folder / f"{name}.exr"))
