"""The virtual environment that holds Blender's Python module, bpy, and the scripts' entry into it.

Where the module cannot be installed, one sentence says so, and the exit code is 0.
"""

import pathlib
import shutil
import subprocess
import sys

PACKAGES = ["bpy", "OpenEXR", "numpy"]
# Each release of bpy is for one version of Python.
PYTHONS = [sys.executable, "python3.11", "python3.13", "python3.12"]


def enter(name, environment, script):
    """Runs a script of that name again in the virtual environment, which is made if it does not exist."""
    if pathlib.Path(sys.prefix).resolve() == environment.resolve():
        return
    python = environment / "bin" / "python"
    if not (environment / "complete").exists():
        fault = install(environment)
        if fault:
            print(f"{name}: not run: Blender's Python module cannot be installed here ({fault})")
            sys.exit(0)
    sys.exit(subprocess.run([python, "-B", script, *sys.argv[1:]]).returncode)


def install(environment):
    """Makes the environment with the first Python that a release of bpy is for; why not, if there is none."""
    faults = []
    for name in PYTHONS:
        python = shutil.which(name)
        if python is None:
            continue
        # A Python without the module venv, a network or a release for it ends in an error.
        steps = [
            [python, "-m", "venv", "--clear", environment],
            [environment / "bin" / "python", "-m", "pip", "install", "--quiet", "--only-binary=:all:", *PACKAGES],
            [environment / "bin" / "python", "-c", "import bpy, OpenEXR"],
        ]
        done = next((done for done in map(tried, steps) if done.returncode != 0), None)
        if done is None:
            (environment / "complete").touch()
            return None
        lines = (done.stderr or done.stdout).strip().splitlines() or ["no message"]
        faults.append(f"{pathlib.Path(python).name}: {lines[-1]}")
    of_pip = [fault for fault in faults if "ERROR" in fault]
    return (of_pip + faults + ["no Python is found"])[0]


def tried(command):
    return subprocess.run(command, capture_output=True, text=True)
