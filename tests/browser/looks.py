"""Themes and widths of the page, and the index of several reports."""

import check

CONTRAST = """(() => {
  const canvas = new OffscreenCanvas(1, 1).getContext('2d', { willReadFrequently: true });
  const rgb = (color) => { canvas.fillStyle = color; canvas.fillRect(0, 0, 1, 1); return [...canvas.getImageData(0, 0, 1, 1).data]; };
  const linear = (code) => (code /= 255) <= 0.04045 ? code / 12.92 : ((code + 0.055) / 1.055) ** 2.4;
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const ground = (node) => { for (; node; node = node.parentElement) { const color = rgb(getComputedStyle(node).backgroundColor); if (getComputedStyle(node).backgroundColor !== 'rgba(0, 0, 0, 0)') return color; } return [255, 255, 255]; };
  const low = [];
  for (const node of document.querySelectorAll('h1, h2, h3, p, th, td, label, button, span, output, a, summary')) {
    if (!node.textContent.trim() || !node.checkVisibility() || node.classList.contains('tag')) continue;
    const [a, b] = [luminance(rgb(getComputedStyle(node).color)), luminance(ground(node))];
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) low.push(`${node.tagName} ${node.textContent.trim().slice(0, 20)} ${ratio.toFixed(2)}`);
  }
  return low;
})()"""

# Elements that scroll by themselves may be wider, and the handle of the split overhangs by half its width.
OUTSIDE = """[...document.querySelectorAll('body *')].filter((node) => node.checkVisibility() && !node.closest('.scroll, svg') && node.id !== 'split'
  && node.getBoundingClientRect().right > innerWidth + 1).map((node) => `${node.tagName} ${node.id}`)"""

GROUND = "getComputedStyle(document.body).backgroundColor"


def schemes(browser):
    grounds = []
    for scheme in ["light", "dark"]:
        browser.scheme(scheme)
        grounds.append(browser.run(GROUND))
        check.equal(f"{scheme}: contrast of at least 4.5", browser.run(CONTRAST), [])
    check.equal("grounds of light and dark", grounds, ["rgb(246, 246, 244)", "rgb(21, 23, 26)"])
    browser.run("byId('theme').click()")
    check.equal("the button changes dark to light", browser.run(GROUND), grounds[0])
    browser.run("byId('theme').click()")
    check.equal("and back", browser.run(GROUND), grounds[1])


def nothing_sticks_out(browser, width):
    check.equal(f"{width} wide: nothing sticks out", browser.run(OUTSIDE), [])
    check.equal(f"{width} wide: no scrolling sideways", browser.run("document.documentElement.scrollWidth"), width)


def widths(browser):
    for width, height in [(360, 740), (800, 1000), (1280, 900), (3840, 2160)]:
        browser.resize(width, height)
        browser.settle()
        nothing_sticks_out(browser, width)
    browser.resize(1280, 900, 2)
    browser.settle()
    check.true("twice as dense: as many pixels as the screen", browser.run("stage.width === Math.round(2 * stage.getBoundingClientRect().width)"))
    browser.resize(1280, 900)


def index(browser, url, expected):
    """`expected` are the names of the test images, in order."""
    browser.open(url, "document.querySelectorAll('#rows tbody tr').length > 0")
    names = "[...document.querySelectorAll('#rows tbody a')].map((link) => link.textContent)"
    check.equal("the worst comes first", browser.run(names), expected)
    check.true("pictures of each", browser.run("[...document.images].length === 2 * document.querySelectorAll('#rows tbody tr').length && [...document.images].every((image) => image.naturalWidth > 0)"))
    check.true("no name became markup", browser.run("typeof hacked === 'undefined' && ![...document.images].some((image) => image.src.endsWith('/x'))"))
    schemes(browser)
    for width in [360, 3840]:
        browser.resize(width, 900)
        browser.settle()
        nothing_sticks_out(browser, width)
    browser.resize(1280, 900)
    browser.run("byId('failed-only').click()")
    check.true("those that passed can be left out", "good.exr" not in browser.run(names), browser.run(names))
    browser.run("document.querySelector('#rows tbody a').focus()")
    browser.key("Enter")
    browser.wait("typeof state === 'object' && state.data !== null")
    check.equal("its link opens the report", browser.run("document.title"), f"FAIL {expected[0]}")
