// Values that are written into large pixels, and the texts around the stage.

/** The smallest side of an image pixel, in CSS pixels, at which its values are written. */
const MIN_SIDE_OF_VALUES = 52;

function drawLabels(pane) {
  const css = state.zoom / density();
  if (css < MIN_SIDE_OF_VALUES) return;
  const channels = pane.kind in mapTables ? shownChannels() : state.look.channels;
  const shown = channels.slice(0, 4);
  const size = Math.min(css / (shown.length + 1), css / 5.2, 15) * density();
  context.font = `${size}px ui-monospace, Consolas, monospace`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  const [left, top] = toStage(pane, 0, 0);
  const from = [Math.max(Math.floor((pane.left - left) / state.zoom), 0), Math.max(Math.floor(-top / state.zoom), 0)];
  const to = [Math.min(Math.ceil((pane.right - left) / state.zoom), picture.width), Math.min(Math.ceil((pane.height - top) / state.zoom), picture.height)];
  for (let y = from[1]; y < to[1]; y++) {
    for (let x = from[0]; x < to[0]; x++) drawValues(pane, x, y, shown, size);
  }
}

function drawValues(pane, x, y, channels, size) {
  const { grid, index } = locate(state.data, x, y);
  if (grid.block > 1) return;
  const center = toStage(pane, x + 0.5, y + 0.5);
  const { canvas } = paint(grid, pane.kind);
  const ink = inkOn(canvas, index % grid.width, Math.floor(index / grid.width));
  channels.forEach((channel, line) => {
    const [reference, test] = [grid.reference[channel][index], grid.test[channel][index]];
    const value = pane.kind === "reference" ? reference : pane.kind === "test" ? test : test - reference;
    const baseline = center[1] + (line - (channels.length - 1) / 2) * size * 1.25;
    context.fillStyle = ink;
    context.fillText(pixelText(value), center[0], baseline);
  });
}

/** A value in about six characters. */
function pixelText(value) {
  if (!Number.isFinite(value)) return float32Text(value);
  const size = Math.abs(value);
  if (size === 0) return "0";
  const text = size >= 1e-3 && size < 1e4 ? String(Number(value.toPrecision(3))) : value.toExponential(1).replace("e+", "e");
  return text.replaceAll("-", "−");
}

/** The sRGB codes of pictures that were read. */
const codes = new WeakMap();

/** Black or white, whichever can be read on a pixel of a canvas. */
function inkOn(canvas, x, y) {
  if (!codes.has(canvas)) codes.set(canvas, canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data);
  const at = 4 * (y * canvas.width + x);
  const [red, green, blue] = codes.get(canvas).subarray(at, at + 3);
  return 0.299 * red + 0.587 * green + 0.114 * blue > 130 ? "#000" : "#fff";
}

/** Shows the names of the images, the zoom, and the scale under the picture. */
function showFrame() {
  const view = state.view;
  byId("tag-left").textContent = view === "flicker" ? state.shown : view === "split" || view === "side" ? "reference" : "";
  byId("tag-right").textContent = view === "split" || view === "side" ? "test" : "";
  byId("split").hidden = view !== "split";
  const zoom = state.zoom / density();
  byId("zoom").textContent = zoom >= 1 ? `${Number(zoom.toPrecision(3))}×` : `${Number((100 * zoom).toPrecision(3))} %`;
  const wanted = JSON.stringify([view, state.layer, state.channel, state.stops, state.scale]);
  if (byId("legend").dataset.made === wanted) return;
  byId("legend").dataset.made = wanted;
  byId("legend").replaceChildren(...legend());
}

function legend() {
  const notFinite = element("span", { class: "entry" }, swatch([picture.colors.not_finite]), "not finite");
  const { channels, light, low, high } = state.look;
  if (state.view in mapTables) {
    const which = shownChannels().length > 1 ? ", of the channel that differs most" : "";
    const signed = state.view === "signed";
    const scale = shortText(state.scale);
    return [element("span", { class: "entry" }, signed ? `−${scale}` : "0", swatch(picture.colors[state.view]), signed ? `+${scale}` : scale),
      element("span", { class: "entry" }, `${signed ? "test − reference" : "|test − reference|"}${which}`), notFinite];
  }
  if (light) return [element("span", { class: "entry" }, `sRGB, exposure ${signedText(state.stops)} stops: white is ${shortText(2 ** -state.stops)}`), notFinite];
  const names = channels.map((channel) => state.data.channels[channel]).join(", ");
  const what = channels.length === 3 ? `${names} as red, green, blue` : names;
  return [element("span", { class: "entry" }, shortText(low), swatch([[0, 0, 0], [255, 255, 255]]), shortText(high)), element("span", { class: "entry" }, what), notFinite];
}

/** A strip of colors. */
function swatch(colors) {
  const strip = element("canvas", { width: colors.length > 1 ? 160 : 12, height: 12, class: "swatch", "aria-hidden": "true" });
  const ink = strip.getContext("2d");
  for (let x = 0; x < strip.width; x++) {
    ink.fillStyle = cssColor(colors.length > 1 ? mapColor(colors, x / (strip.width - 1)) : colors[0]);
    ink.fillRect(x, 0, 1, strip.height);
  }
  return strip;
}
