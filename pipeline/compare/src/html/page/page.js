// The start of the page.

/** Gives the canvas one pixel for each pixel of the screen. */
function resize() {
  const box = byId("stage-box").getBoundingClientRect();
  const size = [box.width, box.height].map((side) => Math.max(Math.round(side * density()), 1));
  if (size[0] === stage.width && size[1] === stage.height) return;
  [stage.width, stage.height] = size;
  if (state.fitted) fit();
  // A resized canvas is empty, so it is drawn at once.
  if (state.data) drawNow();
}

function begin() {
  showHead();
  showGates();
  showMetrics();
  showOther();
  showAttributes();
  fillControls();
  listenToControls();
  listenToPointer();
  listenToKeys();
  setView(state.view);
  new ResizeObserver(resize).observe(byId("stage-box"));
  resize();
  chooseLayer(0);
}

begin();
