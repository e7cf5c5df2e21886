// The canvas with its panes, which are panned and zoomed together.

const stage = byId("stage");
const context = stage.getContext("2d");

/** The number of screen pixels of a CSS pixel. */
const density = () => window.devicePixelRatio || 1;

/** The smallest side of an image pixel, in CSS pixels, at which its borders are drawn. */
const MIN_SIDE_OF_BORDERS = 12;

/** The panes: rectangles of the stage in screen pixels, clipped to `left` and `right`, with the kind of picture they show. */
function panes() {
  const [width, height] = [stage.width, stage.height];
  const pane = (kind, x, paneWidth, left, right) => ({ kind, x, width: paneWidth, height, left, right });
  if (state.view === "side") {
    const half = Math.floor(width / 2);
    return [pane("reference", 0, half, 0, half), pane("test", half, width - half, half, width)];
  }
  if (state.view === "split") {
    const cut = Math.round(state.split * width);
    return [pane("reference", 0, width, 0, cut), pane("test", 0, width, cut, width)];
  }
  return [pane(state.view === "flicker" ? state.shown : state.view, 0, width, 0, width)];
}

/** The point of the stage, in screen pixels, at a point of the image. */
function toStage(pane, x, y) {
  return [pane.x + pane.width / 2 + (x - state.center[0]) * state.zoom, pane.height / 2 + (y - state.center[1]) * state.zoom];
}

/** The point of the image at a point of the stage in screen pixels. */
function toImage(stageX, stageY) {
  const all = panes();
  const pane = all.find((candidate) => stageX < candidate.right) ?? all[all.length - 1];
  return [(stageX - pane.x - pane.width / 2) / state.zoom + state.center[0], (stageY - pane.height / 2) / state.zoom + state.center[1]];
}

let drawPending = false;

/** Requests that the next frame is drawn. */
function draw() {
  if (drawPending) return;
  drawPending = true;
  requestAnimationFrame(() => {
    drawPending = false;
    if (state.data) drawNow();
  });
}

function drawNow() {
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.clearRect(0, 0, stage.width, stage.height);
  for (const pane of panes()) {
    context.save();
    context.beginPath();
    context.rect(pane.left, 0, pane.right - pane.left, pane.height);
    context.clip();
    state.data.grids.forEach((grid) => drawGrid(pane, grid));
    if (state.zoom >= MIN_SIDE_OF_BORDERS * density()) drawBorders(pane);
    drawLabels(pane);
    drawCursor(pane);
    context.restore();
  }
  showFrame();
}

/** Draws the visible blocks of a grid only, because at high zoom the whole would exceed the largest canvas. */
function drawGrid(pane, grid) {
  const { canvas, holes } = paint(grid, pane.kind);
  const [first, last] = [visible(pane, grid, 0), visible(pane, grid, 1)];
  const [width, height] = [last[0] - first[0], last[1] - first[1]];
  if (width <= 0 || height <= 0) return;
  const [x, y] = toStage(pane, grid.x + first[0] * grid.block, grid.y + first[1] * grid.block);
  const size = state.zoom * grid.block;
  context.save();
  const [right, bottom] = toStage(pane, picture.width, picture.height);
  context.beginPath();
  context.rect(-1e6, -1e6, right + 1e6, bottom + 1e6);
  context.clip();
  context.imageSmoothingEnabled = size < 1;
  context.imageSmoothingQuality = "high";
  context.drawImage(canvas, ...first, width, height, x, y, width * size, height * size);
  drawHoles(pane, grid, holes);
  context.restore();
}

/** The column and row of the first visible block (`end` 0), or of the one after the last (`end` 1). */
function visible(pane, grid, end) {
  const edges = end ? [pane.right, pane.height] : [pane.left, 0];
  const origin = toStage(pane, grid.x, grid.y);
  const limits = [grid.width, grid.height];
  return edges.map((edge, i) => {
    const block = (edge - origin[i]) / (state.zoom * grid.block);
    return Math.min(Math.max(end ? Math.ceil(block) : Math.floor(block), 0), limits[i]);
  });
}

/** Enlarges blocks that are not finite, which would vanish in small pictures. */
function drawHoles(pane, grid, holes) {
  const size = state.zoom * grid.block;
  const side = Math.max(size, 4 * density());
  if (side === size) return;
  context.fillStyle = cssColor(picture.colors.not_finite);
  for (const hole of holes.slice(0, 5000)) {
    const [column, row] = [hole % grid.width, Math.floor(hole / grid.width)];
    const [x, y] = toStage(pane, grid.x + (column + 0.5) * grid.block, grid.y + (row + 0.5) * grid.block);
    context.fillRect(x - side / 2, y - side / 2, side, side);
  }
}

function drawBorders(pane) {
  const [left, top] = toStage(pane, 0, 0);
  const [right, bottom] = toStage(pane, picture.width, picture.height);
  context.beginPath();
  for (let x = left + Math.max(Math.floor((pane.left - left) / state.zoom), 0) * state.zoom; x <= Math.min(right, pane.right); x += state.zoom) {
    context.moveTo(Math.round(x) + 0.5, Math.max(top, 0));
    context.lineTo(Math.round(x) + 0.5, Math.min(bottom, pane.height));
  }
  for (let y = top + Math.max(Math.floor(-top / state.zoom), 0) * state.zoom; y <= Math.min(bottom, pane.height); y += state.zoom) {
    context.moveTo(Math.max(left, pane.left), Math.round(y) + 0.5);
    context.lineTo(Math.min(right, pane.right), Math.round(y) + 0.5);
  }
  context.strokeStyle = "rgb(128 128 128 / 0.5)";
  context.lineWidth = 1;
  context.stroke();
}

/** Draws a frame that is visible on any color: dark outside, bright inside. */
function drawCursor(pane) {
  const [x, y] = toStage(pane, ...state.cursor);
  const size = Math.max(state.zoom, 7 * density());
  const shift = (size - state.zoom) / 2;
  for (const [color, grow] of [["#000", 1.5], ["#fff", 0]]) {
    context.strokeStyle = color;
    context.lineWidth = 1.5 * density();
    const extra = grow * density();
    context.strokeRect(x - shift - extra, y - shift - extra, size + 2 * extra, size + 2 * extra);
  }
}
