// Mouse, pen and fingers on the picture: a move reads a pixel, a drag pans, the wheel and two fingers zoom.

/** The points of the stage, in screen pixels, of the pointers that are down. */
const pointers = new Map();

function pointOf(event) {
  const box = stage.getBoundingClientRect();
  return [(event.clientX - box.left) * density(), (event.clientY - box.top) * density()];
}

function pointerDown(event) {
  stage.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, pointOf(event));
  moveCursor(...toImage(...pointOf(event)));
}

function pointerMove(event) {
  const point = pointOf(event);
  const before = pointers.get(event.pointerId);
  if (!before) {
    moveCursor(...toImage(...point));
    return;
  }
  const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
  pointers.set(event.pointerId, point);
  if (other) {
    const distance = ([x, y]) => Math.hypot(x - other[0], y - other[1]);
    if (distance(before) > 0) zoomBy(distance(point) / distance(before), other);
  } else {
    pan(before[0] - point[0], before[1] - point[1]);
  }
}

/** Moves the view by screen pixels. */
function pan(x, y) {
  state.center = [state.center[0] + x / state.zoom, state.center[1] + y / state.zoom];
  state.fitted = false;
  draw();
}

function pointerUp(event) {
  pointers.delete(event.pointerId);
}

/** Zooms by the steps of a wheel or by the finer ones of a touch pad. */
function wheel(event) {
  event.preventDefault();
  const lines = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : 30;
  zoomBy(2 ** (-Math.min(Math.max(event.deltaY * lines, -400), 400) / 200), pointOf(event));
}

function listenToPointer() {
  stage.addEventListener("pointerdown", pointerDown);
  stage.addEventListener("pointermove", pointerMove);
  stage.addEventListener("pointerup", pointerUp);
  stage.addEventListener("pointercancel", pointerUp);
  stage.addEventListener("wheel", wheel, { passive: false });
}
