// The values of one pixel, and the buttons of the worst pixels.

function showReadout() {
  const [x, y] = state.cursor;
  byId("position").textContent = `${x + picture.window[0]}, ${y + picture.window[1]}`;
  const found = locate(state.data, x, y);
  const rows = state.data.channels.map((name, channel) => {
    const [reference, test] = [found.grid.reference[channel][found.index], found.grid.test[channel][found.index]];
    const cells = [float32Text(reference), float32Text(test), differenceText(reference, test)];
    const odd = [reference, test, test - reference].map((value) => !Number.isFinite(value));
    return element("tr", {}, element("th", { scope: "row" }, name),
      ...cells.map((text, i) => element("td", odd[i] ? { class: "not-finite" } : {}, text)));
  });
  byId("readout").tBodies[0].replaceChildren(...rows);
  const { block } = found.grid;
  byId("pixel-note").textContent = block > 1 ? `These are means of ${block} × ${block} pixels; single pixels are shown around the worst ones.` : "";
}

/** The difference in float64, with six digits; the exact one follows from the two values. */
function differenceText(reference, test) {
  const difference = test - reference;
  if (!Number.isFinite(difference)) return float32Text(difference);
  const size = Math.abs(difference);
  const text = size > 0 && size < 1e-4 ? numberText(difference.toExponential(5)) : numberText(Number(difference.toPrecision(6)));
  return difference > 0 ? `+${text}` : text;
}

/** Chooses the pixel that is read. */
function moveCursor(x, y) {
  if (!state.data) return;
  state.cursor = [clamp(Math.floor(x), picture.width), clamp(Math.floor(y), picture.height)];
  showReadout();
  draw();
}

function clamp(number, count) {
  return Math.min(Math.max(number, 0), count - 1);
}

/** Pans so that the pixel that is read lies within the stage. */
function follow() {
  const all = panes();
  const pane = state.view === "side" ? all[0] : { ...all[0], left: 0, right: stage.width };
  const point = toStage(pane, state.cursor[0] + 0.5, state.cursor[1] + 0.5);
  [[pane.x, pane.x + pane.width], [0, pane.height]].forEach(([low, high], i) => {
    const margin = Math.min(state.zoom, (high - low) / 4);
    const beyond = point[i] < low + margin ? point[i] - low - margin : point[i] > high - margin ? point[i] - high + margin : 0;
    if (beyond) {
      state.center[i] += beyond / state.zoom;
      state.fitted = false;
    }
  });
  draw();
}

/** Shows a button for the worst pixel of each channel. */
function showWorst() {
  const buttons = layerReport().channels.map((channel, number) => {
    const { pixel, error } = channel.max;
    if (error === 0) return element("span", { class: "small" }, `${channel.name}: no difference`);
    const label = `${channel.name}: ${pixel.join(", ")}`;
    return element("button", { type: "button", title: `error ${shortText(error)}`, click: () => goToWorst(number) }, label);
  });
  byId("worst").replaceChildren(...buttons);
}

/** Shows the worst pixel of a channel, large enough to read its values, and not under the handle of the split. */
function goToWorst(number) {
  const { pixel } = layerReport().channels[number].max;
  const [x, y] = pixel.map((coordinate, i) => coordinate - picture.window[i]);
  state.zoom = Math.max(state.zoom, (MIN_SIDE_OF_VALUES + 12) * density());
  const side = state.split > 0.5 ? state.split - 1 : state.split;
  state.center = [x + 0.5 - (state.view === "split" ? (side / 2) * stage.width / state.zoom : 0), y + 0.5];
  state.fitted = false;
  moveCursor(x, y);
}
