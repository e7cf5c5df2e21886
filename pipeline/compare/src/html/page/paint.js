// Pictures of grids, with one pixel for each block.

/** The last picture of each kind and grid, with the state that it was made for. */
const painted = new Map();

/** The picture of a grid; `kind` is `reference`, `test`, `signed` or `absolute`. */
function paint(grid, kind) {
  const made = JSON.stringify([state.layer, state.channel, state.data.grids.indexOf(grid),
    kind in mapTables ? state.scale : state.stops]);
  const name = `${kind} ${state.data.grids.indexOf(grid)}`;
  if (painted.get(name)?.made !== made) painted.set(name, { made, ...paintAnew(grid, kind) });
  return painted.get(name);
}

function paintAnew(grid, kind) {
  const canvas = element("canvas", { width: grid.width, height: grid.height });
  const context = canvas.getContext("2d");
  const image = context.createImageData(grid.width, grid.height);
  const colors = kind in mapTables ? errorColors(grid, kind) : valueColors(grid, kind);
  const holes = [];
  for (let i = 0, at = 0; i < grid.width * grid.height; i++, at += 4) {
    if (!colors(i, image.data, at)) {
      image.data.set(picture.colors.not_finite, at);
      holes.push(i);
    }
    image.data[at + 3] = 255;
  }
  context.putImageData(image, 0, 0);
  return { canvas, holes };
}

/** A function that writes the color of a block, and returns whether all values of the block are finite. */
function valueColors(grid, kind) {
  const planes = state.look.channels.map((channel) => grid[kind][channel]);
  const [first, second, third] = planes.length === 3 ? planes : [planes[0], planes[0], planes[0]];
  const { light, low, high } = state.look;
  const factor = 2 ** state.stops;
  const code = light ? (value) => srgbCode(value * factor) : (value) => Math.round((255 * (value - low)) / (high - low));
  return (i, bytes, at) => {
    bytes[at] = code(first[i]);
    bytes[at + 1] = code(second[i]);
    bytes[at + 2] = code(third[i]);
    return Number.isFinite(first[i]) && Number.isFinite(second[i]) && Number.isFinite(third[i]);
  };
}

/** The same function for the error of the channel that differs most. */
function errorColors(grid, kind) {
  const pairs = shownChannels().map((channel) => [grid.reference[channel], grid.test[channel]]);
  const [map, scale] = [mapTables[kind], state.scale];
  return (i, bytes, at) => {
    const error = largestError(pairs, i);
    const part = kind === "signed" ? 0.5 + error / scale / 2 : Math.abs(error) / scale;
    const step = 3 * Math.round(1024 * Math.min(Math.max(part, 0), 1));
    bytes[at] = map[step];
    bytes[at + 1] = map[step + 1];
    bytes[at + 2] = map[step + 2];
    return Number.isFinite(error);
  };
}

/** Test minus reference of the channel that differs most, or NaN if any difference is not finite. */
function largestError(pairs, i) {
  let largest = 0;
  for (const [reference, test] of pairs) {
    const error = test[i] - reference[i];
    if (!Number.isFinite(error)) return NaN;
    if (Math.abs(error) > Math.abs(largest)) largest = error;
  }
  return largest;
}
