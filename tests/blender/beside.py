"""Our pictures of spheres beside those of Cycles, which `make cycles` makes: python3 beside.py --programs FOLDER
--folder FOLDER --environment FOLDER --report FOLDER.

Each sphere of spheres.py is rendered twice by both with other random numbers, so that noise is told from differences.
Opaque spheres are computed by quadrature.py too, by the models of both. page.py writes docs/reports/cycles.md.
"""

import argparse
import os
import pathlib

from environment import enter

# Width and height of a picture, and paths for each pixel of ours.
PIXELS, PATHS = 128, {"metal": 64, "plastic": 64, "rough": 64, "smooth": 32}
LAYERS = {"diffuse": ["diffuse"], "glossy": ["specular"], "transmission": ["subsurface", "transmission"]}


def theirs(path):
    """The beauty of a picture of Cycles, and its layers, each an array of rows, columns and channels."""
    import numpy
    import OpenEXR

    with OpenEXR.File(str(path), separate_channels=True) as file:
        planes = {name: channel.pixels for part in file.parts for name, channel in part.channels.items()}

    def plane(name):
        return numpy.stack([planes[f"ViewLayer.{name}.{c}"] for c in "RGB"], -1).astype(float)

    layers = {"beauty": plane("Combined")}
    for name in LAYERS:
        title = name.capitalize()
        layers[name] = (plane(f"{title} Direct") + plane(f"{title} Indirect")) * plane(f"{title} Color")
    return layers


def stacked(planes, prefix, names="RGB"):
    import numpy

    return numpy.stack([planes[f"{prefix}{c}"] for c in names], -1).astype(float)


def ours(planes):
    """The same of a picture of ours."""
    layers = {"beauty": stacked(planes, "")}
    for name, parts in LAYERS.items():
        layers[name] = sum(stacked(planes, f"{part}.") for part in parts)
    return layers


def processor_seconds():
    """The time of all threads of this process, in which Cycles runs, and of the programs that it has run."""
    return sum(os.times()[:4])


def render_theirs(kind, folder, samples):
    """Two pictures of Cycles with other random numbers."""
    import spheres
    from case import Pair

    pictures, start = [], processor_seconds()
    for seed in (1, 2):
        path = folder / f"{kind}-{samples}.cycles{seed}.exr"
        spheres.render(path, samples, seed)
        pictures.append(theirs(path))
    return Pair(pictures, (processor_seconds() - start) / 2)


def render_ours(kind, programs, light, spp, *options):
    """Two pictures of ours with other clouds, and the channels of one."""
    from case import Pair
    from run import channels

    pictures, start = [], processor_seconds()
    opaque, light = kind in ("metal", "plastic"), ("--environment", light)
    name = "-".join([kind, str(spp), *(option.strip("-") for option in options)])
    for seed in (1, 2):
        cloud, image = f"{kind}.{seed}.cloud", f"{name}.{seed}.exr"
        samples = ["-n", "1k" if opaque else "200k"]
        programs.run("sample-surface", f"{kind}.glb", *samples, "--seed", seed, *light, "-o", cloud)
        fixed = ["--calibration", "none"] if opaque else []
        paths = ["--seed", seed, "--width", PIXELS, "--spp", spp]
        programs.run("gather", cloud, f"{kind}.glb", *paths, *light, *fixed, *options, "-o", image)
        _, planes = channels(programs.folder / image)
        pictures.append(ours(planes))
    return Pair(pictures, (processor_seconds() - start) / 2), planes


def shrunk(mask, pixels):
    """A mask without its border."""
    import numpy

    for _ in range(pixels):
        inner = mask.copy()
        for axis in (0, 1):
            for step in (1, -1):
                inner &= numpy.roll(mask, step, axis)
        mask = inner
    return mask


def seen(planes, mask):
    """The normals of the points seen in the pixels of a mask, and the directions to the viewer, with Y up."""
    import spheres

    view = spheres.eye() - stacked(planes, "P.", "XYZ")[mask]
    return stacked(planes, "N.", "XYZ")[mask], view / (view**2).sum(1, keepdims=True) ** 0.5


def by_quadrature(kind, radiance, normals, view):
    """What the models say of a rough sphere. A shell mirrors by one model in both."""
    import quadrature
    import spheres

    shell = {"color": (0, 0, 0), "roughness": spheres.SHELL_ROUGHNESS, "index": spheres.INDEX}
    names = {"metal": ("ours", "theirs"), "plastic": ("ours", "theirs", "exact"), "rough": ("theirs",)}[kind]
    stated = spheres.OPAQUE.get(kind, shell)
    return {name: quadrature.reflected(stated, name, radiance, view, normals) for name in names}


def measured(kind, programs, light):
    """One sphere, made, exported and rendered by both."""
    import case
    import scene
    import spheres

    spheres.make(kind, light, PIXELS)
    scene.export(programs.folder / f"{kind}.glb")
    mine, planes = render_ours(kind, programs, light, PATHS[kind])
    sphere = abs(stacked(planes, "N.", "XYZ")).sum(-1) > 0
    other = render_theirs(kind, programs.folder, spheres.SAMPLES[kind])
    found = case.Case(kind, mine, other, shrunk(sphere, 2), shrunk(~sphere, 2))
    normals, view = seen(planes, found.mask)
    found.cosines = (normals * view).sum(1)
    if kind == "metal":
        few = render_ours(kind, programs, light, 1)[0], render_theirs(kind, programs.folder, 1)
        found.noise_of_one = [pair.noise(found.mask) for pair in few]
    if kind in ("rough", "smooth"):
        found.exact, _ = render_ours(kind, programs, light, PATHS[kind], "--reference")
    if kind != "smooth":
        found.models = by_quadrature(kind, spheres.pixels(light), *seen(planes, found.points))
    return found


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", type=pathlib.Path, required=True)
    parser.add_argument("--folder", type=pathlib.Path, required=True)
    parser.add_argument("--environment", type=pathlib.Path, required=True)
    parser.add_argument("--report", type=pathlib.Path, required=True)
    parser.add_argument("--light", type=pathlib.Path, default=pathlib.Path("data/environments/studio.hdr"))
    options = parser.parse_args()
    enter("cycles", options.environment, __file__)
    import bpy
    import page
    import spheres
    from run import Programs

    folder, light = options.folder.resolve(), options.light.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    programs = Programs(options.programs.resolve(), folder)
    found = {}
    for kind in spheres.SAMPLES:
        found[kind] = measured(kind, programs, light)
        print(f"{kind}: light of ours over that of Cycles {found[kind].ratio()[0]}", flush=True)
    page.write(found, bpy.app.version_string, (PATHS["metal"], spheres.SAMPLES["metal"]), options.report)


if __name__ == "__main__":
    main()
