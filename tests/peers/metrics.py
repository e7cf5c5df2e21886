"""Compares SSIM and PSNR with scikit-image, and FLIP with NVIDIA's flip-evaluator, on the pictures of tests/peers/images.

`make peers` runs it. It makes a virtual environment of pinned versions in the folder of --environment, and ends with 1 if
`compare` disagrees. --write makes the pictures and expected.json again, which `cargo test -p compare` reads instead of
Python.
"""

import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import venv

HERE = pathlib.Path(__file__).resolve().parent
IMAGES, EXPECTED = HERE / "images", HERE / "expected.json"
PACKAGES = ["scikit-image==0.26.0", "flip-evaluator==1.7", "OpenEXR==3.5.3", "numpy==2.4.6"]
PAIRS = [("base", test) for test in ("base", "noise", "blur", "firefly", "brighter", "negative")]
PAIRS += [("firefly", "base"), ("negative", "base"), ("gray", "gray-tinted")]
PAIRS += [(size, f"{size}-noise") for size in ("17x13", "7x40", "1x1", "140x20", "20x140")]
# Tolerances; that of PSNR is in dB.
TOLERANCE = {"psnr": 1e-4, "ssim": 1e-4, "flip_ldr": 1e-3, "flip_hdr": 1e-3, "start": 1e-4, "stop": 1e-4, "count": 0}


def enter(environment, arguments):
    """Runs this script again in its virtual environment, which is made if it does not exist."""
    python = environment / "bin" / "python"
    if pathlib.Path(sys.prefix).resolve() == environment.resolve():
        return
    stamp = environment / "packages"
    if not stamp.exists() or stamp.read_text().split() != PACKAGES:
        venv.create(environment, with_pip=True, clear=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
        stamp.write_text("\n".join(PACKAGES))
    sys.exit(subprocess.run([python, __file__, *arguments]).returncode)


def read(name):
    import numpy
    import OpenEXR

    with OpenEXR.File(str(IMAGES / f"{name}.exr"), separate_channels=True) as file:
        planes = [file.channels()[c].pixels for c in "RGB"]
    return numpy.stack(planes, -1).astype(numpy.float64)


def display(linear):
    """Exposure 0, clamped to 0..1, the curve of sRGB."""
    import numpy

    x = numpy.clip(linear, 0, 1)
    return numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def peers(reference, test):
    """Values of the other implementations; null where there is none."""
    import flip_evaluator
    import numpy
    from skimage.metrics import peak_signal_noise_ratio, structural_similarity

    shown = [display(reference), display(test)]
    equal = numpy.array_equal(*shown)
    result = {"psnr": None if equal else float(peak_signal_noise_ratio(*shown, data_range=1))}
    window = {"gaussian_weights": True, "sigma": 1.5, "use_sample_covariance": False}
    large = min(reference.shape[:2]) >= 11
    similarity = structural_similarity(*shown, data_range=1, channel_axis=-1, **window) if large else None
    result["ssim"] = None if similarity is None else float(similarity)
    single = [numpy.ascontiguousarray(picture, numpy.float32) for picture in shown]
    result["flip_ldr"] = float(flip_evaluator.evaluate(*single, "LDR", applyMagma=False)[1])
    # flip-evaluator requires radiance that is not negative.
    single = [numpy.ascontiguousarray(numpy.maximum(p, 0), numpy.float32) for p in (reference, test)]
    _, mean, used = flip_evaluator.evaluate(*single, "HDR", applyMagma=False)
    result["flip_hdr"] = float(mean)
    result |= {"start": used["startExposure"], "stop": used["stopExposure"], "count": used["numExposures"]}
    return result


def ours(program, reference, test):
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "report.json"
        files = [IMAGES / f"{name}.exr" for name in (reference, test)]
        subprocess.run([program, *files, "--flip", "--quiet", "--json", report], check=True, stdout=subprocess.DEVNULL)
        picture = json.loads(report.read_text())["picture"]
    exposures = picture["flip_hdr"]["exposures"]
    means = {f"flip_{kind}": picture[f"flip_{kind}"]["mean"] for kind in ("ldr", "hdr")}
    return {"psnr": picture["psnr"], "ssim": picture["ssim"], **means, **exposures}


def agree(name, expected, found):
    if expected is None or found is None:
        return expected is found
    return math.isfinite(found) and abs(found - expected) <= TOLERANCE[name]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--compare", default="target/release/compare", help="the program")
    parser.add_argument("--environment", type=pathlib.Path, default="target/peers-venv", help="folder of the packages")
    parser.add_argument("--write", action="store_true", help="make the pictures and expected.json again")
    arguments = parser.parse_args()
    enter(arguments.environment, sys.argv[1:])
    if arguments.write:
        import images

        IMAGES.mkdir(exist_ok=True)
        images.write(IMAGES)
    pairs, wrong = [], 0
    for reference, test in PAIRS:
        expected = peers(read(reference), read(test))
        pairs.append({"reference": reference, "test": test, **expected})
        found = ours(arguments.compare, reference, test)
        for metric, value in expected.items():
            good = agree(metric, value, found[metric])
            wrong += not good
            print(f"{reference:>10} {test:<14} {metric:<9} {value!s:<22} {found[metric]!s:<22} {'' if good else 'DIFFERS'}")
    if arguments.write:
        EXPECTED.write_text(json.dumps({"packages": PACKAGES, "pairs": pairs}, indent=1) + "\n")
    print(f"{wrong} figures differ")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
