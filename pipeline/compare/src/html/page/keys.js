// The keyboard. Arrow keys act on the element that has the focus; other keys work everywhere but in input fields.

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

const cycle = (number, count, back) => (number + (back ? count - 1 : 1)) % count;

/** The keys with their actions; `back` says whether shift is held. */
const KEYS = [
  ...VIEWS.map(({ id, name }, i) => ({ keys: [String(i + 1)], words: name, act: () => byId(`view-${id}`).click() })),
  { keys: [" "], name: "Space", words: "Reference or test (flicker)", act: () => { if (state.view !== "flicker") setView("flicker"); swap(); } },
  { keys: ["t"], words: "Timed flicker", act: () => { setView("flicker"); setTimed(!byId("timed").checked); } },
  { keys: ["[", "]"], words: "Split to the left, to the right", act: (back, key) => setSplit(state.split + (key === "[" ? -0.02 : 0.02)) },
  { keys: ["e"], words: "Exposure up; with shift down", act: (back) => setStops(state.stops + (back ? -0.5 : 0.5)) },
  { keys: ["a"], words: "Automatic exposure, or scale of the error", act: () => (state.view in mapTables ? setScale(automaticScale()) : setStops(automaticStops())) },
  { keys: ["s"], words: "Scale of the error halved; with shift doubled", act: (back) => setScale(state.scale * (back ? 2 : 0.5)) },
  { keys: ["l"], words: "Next layer; with shift the previous one", act: (back) => chooseLayer(cycle(state.layer, picture.layers.length, back)) },
  { keys: ["c"], words: "Next channel; with shift the previous one", act: nextChannel },
  { keys: ["w"], words: "Worst pixel of the next channel", act: nextWorst },
  { keys: ["+", "=", "-"], name: "+ −", words: "Zoom at the pixel", act: (back, key) => { zoomBy(key === "-" ? 0.5 : 2); } },
  { keys: ["f", "0"], words: "Whole picture", act: fit },
  { keys: ["o"], words: "One screen pixel for a pixel", act: () => setZoom(1) },
  { keys: ["d"], words: "Dark or light", act: toggleTheme },
  { keys: ["?"], words: "This list", act: () => byId("help").showModal() },
];

const OTHER_KEYS = [
  ["← ↑ → ↓", "Next pixel (focus on the picture), or move the split (focus on its handle)"],
  ["Shift ← ↑ → ↓", "Move the picture"],
  ["Ctrl ← ↑ → ↓", "Move by ten pixels"],
];

function nextChannel(back) {
  const count = state.data.channels.length;
  if (count > 1) chooseLayer(state.layer, cycle(state.channel + 1, count + 1, back) - 1);
}

let worst = -1;

function nextWorst(back) {
  worst = cycle(worst, layerReport().channels.length, back && worst >= 0);
  goToWorst(worst);
}

function pressed(event) {
  if (event.altKey || event.metaKey || byId("help").open) return;
  if (event.target === stage && event.key in ARROWS) {
    arrow(event);
    return;
  }
  const field = event.target.matches("select, input[type=number]") || (event.target.matches("button, input, a, summary") && event.key === " ");
  if (event.ctrlKey || field || !byId("keys-on").checked || !state.data) return;
  const known = KEYS.find(({ keys }) => keys.includes(event.key.toLowerCase()));
  if (!known) return;
  event.preventDefault();
  known.act(event.shiftKey, event.key);
}

function arrow(event) {
  event.preventDefault();
  const [x, y] = ARROWS[event.key];
  if (event.shiftKey) {
    pan((x * stage.width) / 10, (y * stage.height) / 10);
    return;
  }
  const step = event.ctrlKey ? 10 : 1;
  moveCursor(state.cursor[0] + x * step, state.cursor[1] + y * step);
  follow();
}

function listenToKeys() {
  document.addEventListener("keydown", pressed);
  const rows = KEYS.map(({ keys, name, words }) => [name ?? keys.join(" ").toUpperCase(), words]);
  byId("keys").tBodies[0].append(...[...rows, ...OTHER_KEYS].map(([keys, words]) =>
    element("tr", {}, element("th", { scope: "row" }, element("kbd", {}, keys)), element("td", {}, words))));
}
