"""Renders scenes that Blender exports: python3 run.py --programs FOLDER --folder FOLDER, which `make blender-test` does.

Blender's Python module, bpy, is installed into a virtual environment (environment.py). The scenes are those of
scene.py. Checked are: the camera's place and field of view; the media of custom properties; units, by the light that
Cycles sees in the same scene; and that the objects of a picture glow.

Planted errors that these checks caught: lamps taken as watts, emission divided by 683, custom properties left out of the
export, a medium that needs a name of its own, a field of view of the other axis.
"""

import argparse
import pathlib
import subprocess
import sys

from environment import enter


def check(what, good, found):
    print(f"{'ok  ' if good else 'FAIL'} {what}: {found}")
    check.failed = check.failed or not good


check.failed = False


class Programs:
    """Our programs, run in a folder."""

    def __init__(self, binaries, folder):
        self.binaries, self.folder = binaries, folder

    def run(self, program, *arguments):
        command = [self.binaries / program, *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, text=True, cwd=self.folder)
        if done.returncode != 0:
            sys.exit(f"blender-test: {program} {' '.join(map(str, arguments))}: {done.stderr}")
        return done.stdout, done.stderr

    def picture(self, name, samples, *arguments):
        """The channels of the picture of an exported scene, and what was said."""
        _, said = self.run("sample-surface", f"{name}.glb", "-n", samples, "-o", f"{name}.cloud")
        options = ("--calibration", "none", "-o", f"{name}.exr", "--preview", f"{name}.png")
        self.run("gather", f"{name}.cloud", f"{name}.glb", *options, *arguments)
        return channels(self.folder / f"{name}.exr"), said


def channels(path):
    """The header of an OpenEXR image, and its channels."""
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        return dict(file.header()), {name: channel.pixels for name, channel in file.channels().items()}


def mean(planes, layer=""):
    return [float(planes[f"{layer}{c}"].mean()) for c in "RGB"]


def statue(programs):
    """The scene of docs/blender.md."""
    import bpy
    import scene

    scene.statue()
    scene.export(programs.folder / "statue.glb")
    seen = bpy.context.scene.camera
    listed, _ = programs.run("gather", "statue.glb", "--list-cameras")
    fields = next(line for line in listed.splitlines() if " Front " in line).split()
    x, y, z = seen.location
    place = [float(field) for field in fields[-4:-1]]
    check("the camera's place, with Y up", all(abs(a - b) < 1e-3 for a, b in zip(place, (x, z, -y))), place)
    import math

    # Blender's field of view is that of the longer side, and ours the vertical one.
    width, height = bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y
    vertical = 2 * math.degrees(math.atan(math.tan(seen.data.angle / 2) * height / width))
    angle = float(fields[fields.index("yfov") + 1])
    check("the vertical field of view, degrees", abs(angle - vertical) < 0.02, (angle, round(vertical, 3)))
    listed, _ = programs.run("gather", "statue.glb", "--list-materials")
    kinds = {line.split()[1]: line for line in listed.splitlines() if line[:1].isdigit()}
    for name, medium in (("Stone", "(marble)"), ("Jelly", "(Jelly)")):
        line = kinds[name]
        check(f"the custom property of {name}", "translucent" in line and line.endswith(medium), line.split()[-1])
    for name in ("Table", "Window"):
        check(f"{name} is no medium", "translucent" not in kinds[name], kinds[name].split()[2])
    (header, planes), said = programs.picture("statue", "200k", "--camera", "Front", "--spp", 8, "--width", 320)
    check("the units are known by the file's writer", "lights in lux and candela, emission in watts" in said, "said")
    check("the picture's size is of the camera's shape", planes["R"].shape == (240, 320), planes["R"].shape)
    media = header["pcsss/media"]
    check("the media are in the picture's header", len(media) == 2 and "marble" in " ".join(media), len(media))
    glow = [planes[f"subsurface.{c}"] for c in "RGB"]
    share = float((sum(glow) > 0).mean())
    check("the share of the picture that shows light from below a surface", 0.05 < share < 0.6, round(share, 3))
    dark = [c for c in "RGB" if not planes[f"subsurface.{c}"].sum() > 0.05 * planes[c].sum()]
    check("that light in each channel", not dark, dark or "RGB")


def lamps(programs):
    """The floor under each kind of lamp is as bright as Cycles renders it."""
    import scene

    for kind in scene.LAMPS:
        scene.lamps(kind)
        scene.export(programs.folder / f"{kind}.glb")
        scene.cycles(programs.folder / f"{kind}.cycles.exr")
        (_, planes), _ = programs.picture(kind, "1k", "--spp", 64, "--width", 64)
        _, theirs = channels(programs.folder / f"{kind}.cycles.exr")
        ratios = [a / b for a, b in zip(mean(planes), mean(theirs))]
        good = all(abs(ratio - 1) < 0.01 for ratio in ratios)
        check(f"light of {kind} over that of Cycles", good, [round(ratio, 4) for ratio in ratios])


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", type=pathlib.Path, required=True)
    parser.add_argument("--folder", type=pathlib.Path, required=True)
    options = parser.parse_args()
    enter("blender-test", options.folder / "environment", __file__)
    import bpy

    print(f"Blender {bpy.app.version_string}")
    programs = Programs(options.programs.resolve(), options.folder.resolve())
    statue(programs)
    lamps(programs)
    sys.exit(1 if check.failed else 0)


if __name__ == "__main__":
    main()
