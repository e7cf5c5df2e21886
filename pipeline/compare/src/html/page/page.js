// The page begins here.

/** The canvas has a pixel for each of the screen's. */
function resize() {
  const box = byId("stage-box").getBoundingClientRect();
  const size = [box.width, box.height].map((side) => Math.max(Math.round(side * density()), 1));
  if (size[0] === stage.width && size[1] === stage.height) return;
  [stage.width, stage.height] = size;
  if (state.fitted) fit();
  // At once: a canvas that was resized is empty.
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
