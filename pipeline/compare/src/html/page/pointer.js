// Mouse, pen and fingers on the picture: moving reads, dragging pans, the wheel and two fingers zoom.

/** Places of the pointers that are down, in screen pixels of the stage. */
const pointers = new Map();

function placeOf(event) {
  const box = stage.getBoundingClientRect();
  return [(event.clientX - box.left) * density(), (event.clientY - box.top) * density()];
}

function pointerDown(event) {
  stage.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, placeOf(event));
  moveCursor(...toImage(...placeOf(event)));
}

function pointerMove(event) {
  const place = placeOf(event);
  const before = pointers.get(event.pointerId);
  if (!before) {
    moveCursor(...toImage(...place));
    return;
  }
  const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
  pointers.set(event.pointerId, place);
  if (other) {
    const distance = ([x, y]) => Math.hypot(x - other[0], y - other[1]);
    if (distance(before) > 0) zoomBy(distance(place) / distance(before), other);
  } else {
    pan(before[0] - place[0], before[1] - place[1]);
  }
}

/** Moves the view by screen pixels. */
function pan(x, y) {
  state.centre = [state.centre[0] + x / state.zoom, state.centre[1] + y / state.zoom];
  state.fitted = false;
  draw();
}

function pointerUp(event) {
  pointers.delete(event.pointerId);
}

/** Steps of a wheel and the fine ones of a touch pad alike. */
function wheel(event) {
  event.preventDefault();
  const lines = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : 30;
  zoomBy(2 ** (-Math.min(Math.max(event.deltaY * lines, -400), 400) / 200), placeOf(event));
}

function listenToPointer() {
  stage.addEventListener("pointerdown", pointerDown);
  stage.addEventListener("pointermove", pointerMove);
  stage.addEventListener("pointerup", pointerUp);
  stage.addEventListener("pointercancel", pointerUp);
  stage.addEventListener("wheel", wheel, { passive: false });
}
