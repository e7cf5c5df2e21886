"""The report of two images, operated by mouse and keys."""

import math

import check
from devtools import SHIFT
from images import HEIGHT, HOSTILE, WIDTH, WINDOW, float32, number

MAGENTA = [255, 0, 212, 255]


def srgb(linear):
    """The sRGB curve (IEC 61966-2-1) as an eight-bit code."""
    linear = min(max(linear, 0.0), 1.0)
    curve = 12.92 * linear if linear <= 0.0031308 else 1.055 * linear ** (1 / 2.4) - 0.055
    return math.floor(255 * curve + 0.5)


class Report:
    def __init__(self, browser, url, reference, test):
        self.browser, self.url, self.reference, self.test = browser, url, reference, test

    def open(self):
        self.browser.open(self.url, "typeof state === 'object' && state.data !== null")

    def text(self, selector):
        return self.browser.run(f"document.querySelector({selector!r}).textContent")

    def point(self, x, y):
        """Screen coordinates of the middle of a pixel; they may be outside the window."""
        return self.browser.run(f"""(() => {{ const box = stage.getBoundingClientRect(); const pane = panes().at(-1);
            const [x, y] = toStage(pane, {x - WINDOW[0] + 0.5}, {y - WINDOW[1] + 0.5});
            return [box.left + x / density(), box.top + y / density()]; }})()""")

    def color(self, x, y, shift=0.25):
        """Color of the canvas in a pixel, beside its middle, where no value is written."""
        return self.browser.run(f"""(() => {{ const pane = panes().at(-1);
            const point = toStage(pane, {x - WINDOW[0]} + {shift}, {y - WINDOW[1]} + {shift}).map(Math.round);
            const one = new OffscreenCanvas(1, 1).getContext('2d', {{ willReadFrequently: true }});
            one.drawImage(stage, -point[0], -point[1]);
            return Array.from(one.getImageData(0, 0, 1, 1).data); }})()""")

    def readout(self):
        return self.browser.run("[...document.querySelectorAll('#readout tbody tr')].map((row) => [...row.cells].map((cell) => cell.textContent))")

    def expected(self, image, x, y, stops=0):
        values = [float32(image[name][number(x, y)]) for name in "RGB"]
        return [*(srgb(value * 2.0 ** stops) for value in values), 255]

    def split_of(self, value):
        self.browser.run(f"setSplit({value})")
        self.browser.settle()


def names_are_texts(report):
    run = report.browser.run
    check.true("no name of a file became markup", run("!document.querySelector('img') && typeof hacked === 'undefined'"))
    check.true("a hostile layer is there by its name", run(f"[...byId('layer').options].some((o) => o.text === {HOSTILE!r})"))
    check.true("a hostile attribute is there as text", HOSTILE in report.text("#attributes"))
    check.equal("the verdict", report.text("#verdict"), "FAIL")
    check.true("the gate is in its table", "max-relmse" in report.text("#gates") and "FAIL" in report.text("#gates"))


def slider(report):
    browser = report.browser
    box = browser.run("(({ left, top, width, height }) => ({ left, top, width, height }))(stage.getBoundingClientRect())")
    at = lambda part: [box["left"] + part * box["width"], box["top"] + box["height"] * 0.4]
    browser.drag(at(0.5), at(0.25))
    check.true("dragging moves the split", abs(browser.run("state.split") - 0.25) < 0.02, browser.run("state.split"))
    check.equal("right of it is the test image", report.color(20, -12), report.expected(report.test, 20, -12))
    browser.run("byId('split').focus()")
    before = browser.run("state.split")
    browser.key("ArrowRight", times=4)
    check.true("arrow keys move it", abs(browser.run("state.split") - before - 0.02) < 1e-9, browser.run("state.split"))
    browser.key("[")
    check.true("and so does [", abs(browser.run("state.split") - before) < 1e-9)
    report.split_of(1)
    check.equal("left of it is the reference", report.color(20, -12), report.expected(report.reference, 20, -12))
    report.split_of(0)


def values(report):
    browser = report.browser
    # Events of wheels have whole coordinates.
    x, y = map(int, report.point(15, -12))
    under = f"((box) => toImage((({x}) - box.left) * density(), (({y}) - box.top) * density()))(stage.getBoundingClientRect())"
    before, point = browser.run("state.zoom"), browser.run(under)
    for _ in range(4):
        browser.mouse("mouseWheel", x, y, deltaX=0, deltaY=-100)
    check.true("the wheel zooms", abs(browser.run("state.zoom") / before - 4) < 1e-6, browser.run("state.zoom"))
    check.true("and keeps the point under the mouse", max(abs(a - b) for a, b in zip(point, browser.run(under))) < 1e-9, point)
    browser.mouse("mouseMoved", *report.point(15, -12))
    check.equal("coordinates of the data window", report.text("#position"), "15, -12")
    green = float32(report.reference["G"][number(15, -12)])
    row = report.readout()[1]
    check.equal("a negative value", [row[0], row[2]], ["G", "−0.5"])
    check.equal("its reference, to the last bit", float32(float(row[1])), green)
    check.true("and its difference", abs(float(row[3].replace("−", "-")) - (-0.5 - green)) < 1e-6, row[3])
    browser.run("byId('fit').click()")
    browser.mouse("mouseMoved", *report.point(12, -18))
    check.equal("NaN in coordinates", report.text("#position"), "12, -18")
    row = report.readout()[0]
    check.equal("NaN and its difference", row[2:], ["NaN", "NaN"])
    browser.drag(report.point(16, -12), report.point(14, -12))
    check.true("dragging moves the picture", browser.run("!state.fitted"))


def written_values(report):
    browser = report.browser
    browser.run("written = []; context.fillText = function (text, ...point) { written.push(text); CanvasRenderingContext2D.prototype.fillText.call(this, text, ...point); }")
    browser.run("document.querySelectorAll('#worst button')[2].click()")
    browser.settle()
    check.equal("the worst pixel of blue", report.text("#position"), "30, -7")
    written = browser.run("written")
    check.true("values are written into the pixels", "4" in written, written[:9])
    browser.run("document.querySelectorAll('#worst button')[0].click(); written = []")
    browser.settle()
    check.equal("NaN is worst of all", report.text("#position"), "12, -18")
    check.true("and written too", "NaN" in browser.run("written"))
    browser.run("delete context.fillText")


def exposure(report):
    browser = report.browser
    for stops in [0, 1, -2.5]:
        browser.run(f"byId('stops').value = '{stops}'; byId('stops').dispatchEvent(new Event('change'))")
        browser.settle()
        check.equal(f"sRGB at {stops} stops", report.color(11, -19), report.expected(report.test, 11, -19, stops))
    codes = browser.run("Array.from({ length: 4001 }, (_, i) => srgbCode(i / 4000))")
    check.equal("the whole curve", codes, [srgb(i / 4000) for i in range(4001)])
    browser.run("stage.focus()")
    browser.key("E", SHIFT)
    check.equal("a key lowers it", browser.run("byId('stops').value"), "-3")
    browser.run("setStops(0)")
    browser.settle()
    check.equal("NaN in a color of its own", report.color(12, -18), MAGENTA)


def flicker(report):
    browser = report.browser
    shown = []
    browser.run("byId('fit').click()")
    browser.key("2")
    for _ in range(2):
        shown.append((report.text("#tag-left"), report.color(14, -15)))
        browser.key(" ")
    expected = [("reference", report.expected(report.reference, 14, -15)), ("test", report.expected(report.test, 14, -15))]
    check.equal("flicker shows both in turn", shown, expected)
    browser.run("byId('interval').value = '500'; byId('timed').click()")
    before = report.text("#tag-left")
    browser.wait(f"byId('tag-left').textContent !== {before!r}", 3)
    check.true("and by itself", True)
    browser.key("3")
    check.true("another view ends that", not browser.run("byId('timed').checked"))


def errors(report):
    browser = report.browser
    browser.run("byId('fit').click()")
    browser.key("4")
    browser.run("byId('scale').value = '0.05'; byId('scale').dispatchEvent(new Event('change'))")
    browser.settle()
    maps = browser.run("picture.colors")
    check.equal("signed: brighter beyond the scale", report.color(20, -12), [*maps["signed"][-1], 255])
    check.equal("signed: darker", report.color(15, -12), [*maps["signed"][0], 255])
    check.equal("signed: NaN", report.color(12, -18), MAGENTA)
    browser.run("chooseLayer(0, 1)")
    browser.settle()
    check.equal("signed: equal", report.color(20, -12), [*maps["signed"][3], 255])
    browser.key("5")
    check.equal("absolute: equal", report.color(20, -12), [*maps["absolute"][0], 255])
    check.equal("absolute: beyond the scale", report.color(15, -12), [*maps["absolute"][-1], 255])
    check.true("the scale is written", "0.05" in report.text("#legend"), report.text("#legend"))
    browser.run("chooseLayer(0)")


def layers(report):
    browser = report.browser
    browser.key("1")
    pick = lambda name: browser.run(f"byId('layer').value = [...byId('layer').options].find((o) => o.text === {name!r}).value; byId('layer').dispatchEvent(new Event('change'))")
    pick("Z")
    browser.wait("state.data.name === 'Z'")
    browser.settle()
    check.true("depth: its range is written", all(part in report.text("#legend") for part in ["1", "6.75"]), report.text("#legend"))
    check.equal("depth: the nearest is black", report.color(10, -20), [0, 0, 0, 255])
    check.true("depth has no exposure", browser.run("byId('exposure-group').hidden"))
    pick("N")
    browser.wait("state.data.name === 'N'")
    browser.settle()
    # Pixel 0: sin 0, cos 0 and 0, as parts of -1 to 1.
    check.equal("vectors from -1 to 1", report.color(10, -20), [128, 255, 128, 255])
    browser.run("stage.focus()")
    name = browser.run("state.data.name")
    browser.key("l")
    browser.wait(f"state.data.name !== {name!r}")
    check.true("a key changes the layer", True)
    pick("beauty")
    browser.wait("state.data.name === 'beauty'")


def histogram(report):
    browser = report.browser
    browser.run("byId('counts').open = true")
    browser.wait("byId('counts').querySelector('table') !== null")
    rows = browser.run("[...byId('counts').querySelectorAll('tbody tr')].map((row) => [...row.cells].slice(1).map((cell) => Number(cell.textContent)))")
    check.equal("counts add up to the pixels", [sum(column) for column in zip(*rows)], [WIDTH * HEIGHT] * 3)
    check.equal("NaN is counted by itself", rows[-1], [1, 0, 0])
    middle = (len(rows) - 2) // 2
    # Blue is brighter by more than the part around zero is wide; one value of green is below.
    check.equal("the part around zero", rows[middle], [WIDTH * HEIGHT - 1, WIDTH * HEIGHT - 1, 0])
    check.equal("green: one below zero", sum(row[1] for row in rows[:middle]), 1)
    check.true("means are marked", browser.run("document.querySelectorAll('#histogram .mean').length === 2 && document.querySelectorAll('#histogram .zero').length === 1"))


def keyboard(report):
    browser = report.browser
    report.open()
    seen = []
    for _ in range(40):
        browser.key("Tab")
        seen.append(browser.run("document.activeElement.id"))
        if seen[-1] == "stage":
            break
    wanted = ["theme", "help-open", "view-split", "layer", "channel", "exposure", "stops", "exposure-auto", "zoom-out", "zoom-in", "fit", "one", "stage"]
    check.true("every control is reached by Tab", all(name in seen for name in wanted), seen)
    check.true("the focus is seen", browser.run("getComputedStyle(stage).outlineStyle !== 'none'"))
    before = report.text("#position")
    browser.key("ArrowRight", times=2)
    browser.key("ArrowUp")
    x, y = map(int, before.split(","))
    check.equal("arrows move the pixel", report.text("#position"), f"{x + 2}, {y - 1}")
    zoom = browser.run("state.zoom")
    browser.key("+")
    check.equal("plus zooms", browser.run("state.zoom"), 2 * zoom)
    center = browser.run("state.center[0]")
    browser.key("ArrowRight", SHIFT)
    check.true("shift and arrows move the picture", browser.run("state.center[0]") > center)
    browser.key("w")
    check.equal("W goes to the worst pixel", report.text("#position"), "12, -18")
    browser.key("?")
    check.true("? opens the list of keys", browser.run("byId('help').open"))
    browser.key("Escape")
    check.true("Escape closes it", not browser.run("byId('help').open"))
    unnamed = browser.run("[...document.querySelectorAll('button, input, select')].filter((node) => !(node.textContent.trim() || node.ariaLabel || node.labels?.[0]?.textContent.trim())).map((node) => node.id)")
    check.equal("every control has a name", unnamed, [])
    twice = browser.run("(() => { const ids = [...document.querySelectorAll('[id]')].map((node) => node.id); return ids.filter((id, i) => ids.indexOf(id) !== i); })()")
    check.equal("every id is there once", twice, [])


ALL = [names_are_texts, slider, values, written_values, exposure, flicker, errors, layers, histogram, keyboard]
