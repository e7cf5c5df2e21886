"""Makes the OpenEXR files beside it: pip install OpenEXR==3.5.3 numpy; exrmaketiled and exrmultipart of
Debian 12 (openexr 3.1.5). foreign.rs knows the formula of the pixels."""

import subprocess

import Imath
import numpy as np
import OpenEXR

WIDTH, HEIGHT = 37, 41
y, x = np.mgrid[0:HEIGHT, 0:WIDTH]


def plane(channel):
    return ((x // 4 + y // 8 + channel) % 9) * 0.25


def channels():
    return {"R": plane(0).astype(np.float32), "G": plane(1).astype(np.float16), "id": (4 * plane(2)).astype(np.uint32)}


def box(left, top, right, bottom):
    return np.array([left, top], np.int32), np.array([right, bottom], np.int32)


def header(compression, **more):
    window = box(-7, 11, -7 + WIDTH - 1, 11 + HEIGHT - 1)
    compression = getattr(OpenEXR, compression + "_COMPRESSION")
    return {"type": OpenEXR.scanlineimage, "compression": compression, "dataWindow": window,
            "displayWindow": box(0, 0, 63, 63)} | more


def write(name, head, values):
    OpenEXR.File(head, values).write(name)


for name, compression in [("none", "NO"), ("zips", "ZIPS"), ("zip", "ZIP"), ("pxr24", "PXR24"), ("htj2k", "HTJ2K256"),
                          ("zstd", "ZSTD"), ("dwaa", "DWAA"), ("b44", "B44")]:
    write(name + ".exr", header(compression), channels())
write("decreasing.exr", header("PIZ", lineOrder=OpenEXR.DECREASING_Y), channels())
tiles = OpenEXR.TileDescription()
tiles.xSize, tiles.ySize = 13, 7
write("random.exr", header("RLE", type=OpenEXR.tiledimage, tiles=tiles, lineOrder=OpenEXR.RANDOM_Y), channels())
write("large-id.exr", header("ZIP"), {"id": np.full((HEIGHT, WIDTH), 2**32 - 1, np.uint32)})

deep = np.empty((HEIGHT, WIDTH), object)
for row in range(HEIGHT):
    for column in range(WIDTH):
        deep[row, column] = np.arange((row + column) % 3 + 1).astype(np.float32)
write("deep.exr", header("ZIPS", type=OpenEXR.deepscanline), {"Z": deep})

half = {"R": plane(0)[:20, :20].astype(np.float32)}
parts = [OpenEXR.Part(header("ZIP"), channels(), "whole"),
         OpenEXR.Part(header("ZIP", dataWindow=box(0, 0, 19, 19)), half, "corner")]
OpenEXR.File(parts).write("windows.exr")

chroma = OpenEXR.Header(36, 40)
single = Imath.PixelType(Imath.PixelType.FLOAT)
chroma["channels"] = {"Y": Imath.Channel(single, 1, 1), "RY": Imath.Channel(single, 2, 2)}
file = OpenEXR.OutputFile("chroma.exr", chroma)
small = plane(0).astype(np.float32)
file.writePixels({"Y": small[:40, :36].tobytes(), "RY": small[:20, :18].tobytes()})
file.close()

for command in ["exrmaketiled -m -t 16 8 zip.exr mip.exr", "exrmaketiled -r -u -t 32 16 zip.exr rip.exr",
                "exrmultipart -combine -i zips.exr mip.exr -o parts.exr -override 1"]:
    subprocess.run(command.split(), check=True)
