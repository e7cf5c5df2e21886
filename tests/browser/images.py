"""Small OpenEXR images of known values."""

import math
import struct

WIDTH, HEIGHT = 24, 16
WINDOW = (10, -20)
HOSTILE = "</script><img src=x onerror=hacked=1>"


def float32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def exr(channels, attributes, width=WIDTH, height=HEIGHT, window=WINDOW):
    """The bytes of a file: uncompressed float32 scan lines. `channels` are rows one after the other, by name."""
    names = sorted(channels)
    text = lambda value: value.encode() + b"\0"
    box = struct.pack("<4i", *window, window[0] + width - 1, window[1] + height - 1)
    # 2: float32, then four bytes of linearity, then the sampling.
    entries = b"".join(text(name) + struct.pack("<iBxxxii", 2, 0, 1, 1) for name in names) + b"\0"
    header = [("channels", "chlist", entries), ("compression", "compression", b"\0"), ("dataWindow", "box2i", box),
              ("displayWindow", "box2i", box), ("lineOrder", "lineOrder", b"\0"), ("pixelAspectRatio", "float", struct.pack("<f", 1)),
              ("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)), ("screenWindowWidth", "float", struct.pack("<f", 1))]
    header += [(name, "string", value.encode()) for name, value in attributes.items()]
    long_names = 0x400 if any(len(name) > 31 for name in [*names, *attributes]) else 0
    start = struct.pack("<II", 20000630, 2 | long_names)
    start += b"".join(text(name) + text(kind) + struct.pack("<i", len(value)) + value for name, kind, value in header) + b"\0"
    size = 4 * width * len(names)
    offsets = [len(start) + 8 * height + row * (8 + size) for row in range(height)]
    lines = []
    for row in range(height):
        samples = [value for name in names for value in channels[name][row * width:(row + 1) * width]]
        lines.append(struct.pack("<ii", window[1] + row, size) + struct.pack(f"<{len(samples)}f", *samples))
    return start + struct.pack(f"<{height}Q", *offsets) + b"".join(lines)


def number(x, y):
    """Index of a pixel, given in coordinates of the data window, in its channel."""
    return (y - WINDOW[1]) * WIDTH + x - WINDOW[0]


def pair():
    """Channels of reference and test. Blue is 0.1 brighter in the test image, except for the pixels changed below."""
    count = WIDTH * HEIGHT
    plane = lambda shift: [0.05 + ((i * 7 + shift) % 13) / 16 for i in range(count)]
    reference = {"R": plane(0), "G": plane(3), "B": plane(5), "Z": [1 + i % WIDTH / 4 for i in range(count)], HOSTILE + ".Y": plane(1),
                 "N.X": [math.sin(i) for i in range(count)], "N.Y": [math.cos(i) for i in range(count)], "N.Z": [0.0] * count}
    reference["R"][number(11, -19)] = 0.2
    test = {name: list(samples) for name, samples in reference.items()}
    test["B"] = [value + 0.1 for value in reference["B"]]
    test["R"][number(12, -18)] = math.nan
    test["G"][number(15, -12)] = -0.5
    test["B"][number(30, -7)] = 4.0
    test["Z"][number(20, -10)] += 2
    return reference, test
