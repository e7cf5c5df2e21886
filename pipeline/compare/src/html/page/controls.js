// The actions of the controls, and how the controls show the state.

function setView(view) {
  state.view = view;
  byId(`view-${view}`).checked = true;
  const errors = view in mapTables;
  byId("scale-group").hidden = !errors;
  byId("exposure-group").hidden = errors || !(state.look?.light ?? true);
  byId("flicker-group").hidden = view !== "flicker";
  if (view !== "flicker") setTimed(false);
  draw();
}

/** The number of layers that were chosen so far. Only the last one is shown, whichever is unpacked first. */
let asked = 0;

async function chooseLayer(number, channel = -1) {
  const request = ++asked;
  const problem = (error) => byId("messages").append(element("p", { class: "note" }, `The layer cannot be shown: ${error.message}`));
  const data = picture.layers[number] ? await loadLayer(number).catch(problem) : null;
  if (!data || request !== asked) return;
  const isNew = state.data !== data;
  Object.assign(state, { layer: number, channel, data, look: look(data, channel) });
  byId("layer").value = String(number);
  const options = data.channels.length > 1 ? [["-1", "all"]] : [];
  data.channels.forEach((name, i) => options.push([String(i), name]));
  byId("channel").replaceChildren(...options.map(([value, name]) => element("option", { value }, name)));
  byId("channel").value = data.channels.length > 1 ? String(channel) : "0";
  if (isNew) setScale(automaticScale());
  setView(state.view);
  showReadout();
  showWorst();
  showHistogram();
}

function setStops(stops) {
  if (!Number.isFinite(stops)) return;
  state.stops = Math.min(Math.max(stops, -30), 30);
  byId("exposure").value = String(state.stops);
  byId("stops").value = String(state.stops);
  draw();
}

function setScale(scale) {
  if (!(scale > 0) || !Number.isFinite(scale)) return;
  state.scale = scale;
  byId("scale").value = String(scale);
  draw();
}

function setSplit(split) {
  state.split = Math.min(Math.max(split, 0), 1);
  byId("split").value = String(state.split);
  draw();
}

/** Zooms by a factor about a point of the stage in screen pixels, which does not move. */
function zoomBy(factor, point = pointOfCursor()) {
  const [x, y] = toImage(...point);
  const zoom = Math.min(Math.max(state.zoom * factor, 1 / 64), 256 * density());
  state.center = [x, y].map((held, i) => held - ((held - state.center[i]) * state.zoom) / zoom);
  Object.assign(state, { zoom, fitted: false });
  draw();
}

/** The point of the stage at the pixel that is read, or the middle of the pane if that is outside. */
function pointOfCursor() {
  const pane = panes()[0];
  const point = toStage(pane, state.cursor[0] + 0.5, state.cursor[1] + 0.5);
  const inside = point[0] >= pane.x && point[0] < pane.x + pane.width && point[1] >= 0 && point[1] < pane.height;
  return inside ? point : [pane.x + pane.width / 2, pane.height / 2];
}

/** Shows the whole image. If it is smaller than the stage, the zoom is a whole number. */
function fit() {
  const pane = panes()[0];
  const zoom = Math.min(pane.width / picture.width, pane.height / picture.height);
  state.zoom = zoom >= 1 ? Math.floor(zoom) : zoom;
  state.center = [picture.width / 2, picture.height / 2];
  state.fitted = true;
  draw();
}

function setZoom(zoom) {
  zoomBy((zoom * density()) / state.zoom);
}

function swap() {
  state.shown = state.shown === "reference" ? "test" : "reference";
  draw();
}

let timer = 0;

function setTimed(timed) {
  byId("timed").checked = timed;
  clearInterval(timer);
  if (timed) timer = setInterval(swap, Number(byId("interval").value));
}

function fillControls() {
  byId("views").append(...VIEWS.map(({ id, name }, i) => {
    const input = element("input", { type: "radio", name: "view", id: `view-${id}`, change: () => { setView(id); if (state.fitted) fit(); } });
    return element("label", { title: `Key ${i + 1}` }, input, element("span", {}, name));
  }));
  byId("layer").append(...picture.layers.map(({ name }, i) => element("option", { value: String(i) }, name)));
}

function listenToControls() {
  const on = (id, event, action) => byId(id).addEventListener(event, action);
  on("layer", "change", () => chooseLayer(Number(byId("layer").value)));
  on("channel", "change", () => chooseLayer(state.layer, Number(byId("channel").value)));
  on("exposure", "input", () => setStops(Number(byId("exposure").value)));
  on("stops", "change", () => setStops(byId("stops").value === "" ? 0 : Number(byId("stops").value)));
  on("exposure-auto", "click", () => setStops(automaticStops()));
  on("scale", "change", () => setScale(Number(byId("scale").value)));
  on("scale-auto", "click", () => setScale(automaticScale()));
  on("split", "input", () => setSplit(Number(byId("split").value)));
  on("zoom-in", "click", () => zoomBy(2));
  on("zoom-out", "click", () => zoomBy(0.5));
  on("fit", "click", fit);
  on("one", "click", () => setZoom(1));
  on("swap", "click", swap);
  on("timed", "change", () => setTimed(byId("timed").checked));
  on("interval", "change", () => setTimed(byId("timed").checked));
  on("help-open", "click", () => byId("help").showModal());
}
