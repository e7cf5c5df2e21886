"""Pictures side by side as PNG: ours, Cycles, and their signed difference, a row for each sphere."""

import struct
import zlib

import numpy
from case import BLOCK, blocks

# The relative difference of full color.
FULL = 0.2


def shown(light, white):
    """Scene-linear light as sRGB of eight bits."""
    c = (light / white).clip(0, 1)
    return (255 * numpy.where(c < 0.0031308, 12.92 * c, 1.055 * c ** (1 / 2.4) - 0.055) + 0.5).astype("u1")


def difference(ours, theirs, scale):
    """Blocks of the difference relative to √(theirs² + (scale/10)²): red where ours is brighter, blue where darker."""
    a, b = blocks(ours), blocks(theirs)
    error = ((a - b) / (b**2 + (scale / 10) ** 2) ** 0.5).mean(-1, keepdims=True) / FULL
    error = error.clip(-1, 1)
    color = 1 - abs(error) * numpy.where(error > 0, [0.15, 0.8, 0.9], [0.9, 0.7, 0.15])
    return (255 * color + 0.5).astype("u1").repeat(BLOCK, 0).repeat(BLOCK, 1)


def row(case):
    ours, theirs = case.ours.mean(), case.theirs.mean()
    white = numpy.quantile(theirs[case.mask], 0.985)
    scale = float(theirs[case.mask].mean())
    return numpy.concatenate([shown(ours, white), shown(theirs, white), difference(ours, theirs, scale)], 1)


def write(cases, path):
    pixels = numpy.concatenate([row(case) for case in cases])
    height, width, _ = pixels.shape
    # Each row of the picture is stored as its difference from the row above (filter 2).
    above = numpy.concatenate([numpy.zeros_like(pixels[:1]), pixels[:-1]])
    lines = b"".join(b"\x02" + line.tobytes() for line in pixels - above)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    parts = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(lines, 9)) + chunk(b"IEND", b"")
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + parts)
