"""Opens reports of `compare` in headless Chromium and works with them: python3 run.py COMPARE-PROGRAM [SCREENSHOTS].

Planted errors that these checks caught: the split not moved by its input, the data window left out of coordinates and of
the way to the worst pixel, bytes of samples in the wrong order, exposure with the wrong sign, the sRGB code cut instead
of rounded, NaN not marked, flicker that shows one image or never begins, errors with the wrong sign, a part of the
histogram lost, a layer that is not changed, texts taken as markup, a request to the network, too little contrast in
dark, a control wider than the window, a picture without focus, a button without a name, the index in the wrong order, a
link that is not escaped, a wheel that zooms at the middle.
"""

import pathlib
import subprocess
import sys
import tempfile
import time

import check
import devtools
import looks
import report
from images import HOSTILE, exr, pair

# A valid file name with quotes, markup, and characters that have a meaning in addresses.
HOSTILE_FILE = "a'\"<b>&#%?.exr"


def compare(program, folder, reference, test, html, *options):
    command = [program, folder / reference, folder / test, "--html", folder / html, "--quiet", *options]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode > 1:
        sys.exit(f"compare: {done.stderr}")


def make(program, folder):
    """Reports in a folder, and their index; the channels of the first."""
    reference, test = pair()
    (folder / "sub").mkdir()
    write = lambda name, channels, **attributes: (folder / name).write_bytes(exr(channels, attributes))
    brighter = {name: [value * 1.001 for value in samples] for name, samples in reference.items()}
    much_brighter = {name: [value * 1.5 for value in samples] for name, samples in reference.items()}
    write("reference.exr", reference, note="one")
    write(HOSTILE_FILE, test, note=HOSTILE)
    write("good.exr", brighter)
    write("bad.exr", much_brighter)
    compare(program, folder, "reference.exr", HOSTILE_FILE, "sub/a'%#?.html", "--max-relmse", "1")
    compare(program, folder, "reference.exr", "good.exr", "good.html", "--max-relmse", "1")
    compare(program, folder, "reference.exr", "bad.exr", "bad.html", "--max-relmse", "0.1")
    reports = [folder / "good.html", folder / "bad.html", folder / "sub/a'%#?.html"]
    subprocess.run([program, "--quiet", "--html-index", folder / "index.html", *reports], check=True)
    return reference, test


def walk(browser, folder, images, screenshots):
    address = lambda name: (folder / name).as_uri()
    page = report.Report(browser, address("sub/a'%#?.html"), *images)
    page.open()
    for part in report.ALL:
        print(part.__name__.replace("_", " "))
        part(page)
    print("looks")
    looks.schemes(browser)
    looks.widths(browser)
    if screenshots:
        browser.screenshot(screenshots / "report.png")
    print("index")
    looks.index(browser, address("index.html"), [HOSTILE_FILE, "bad.exr", "good.exr"])
    print("silence")
    check.equal("no error or warning in the console", browser.complaints, [])
    outside = [url for url in browser.requests if not url.startswith(("file:", "data:", "blob:"))]
    check.equal("no request to the network", outside, [])
    files = [url for url in browser.requests if url.startswith("file:") and not url.split("?")[0].endswith(".html")]
    check.equal("no other file is read", files, [])


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    screenshots = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else None
    chromium = devtools.find()
    if chromium is None:
        sys.exit("browser-test: no Chromium found; install it (Debian: apt install chromium)")
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        images = make(program, folder)
        browser = devtools.Browser(chromium)
        try:
            walk(browser, folder, images, screenshots)
        except RuntimeError as problem:
            check.true("nothing stopped the walk", False, [str(problem), *browser.complaints])
        finally:
            browser.close()
    print(f"browser-test: {len(check.failures)} failures, {time.monotonic() - start:.0f} s")
    sys.exit(1 if check.failures else 0)


main()
