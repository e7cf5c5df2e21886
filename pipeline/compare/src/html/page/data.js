// The samples: float32, byte-shuffled, deflated, in base64. Each layer is unpacked when it is first looked at.

const report = block("report");
const picture = block("picture");

/** Promises of layers, by number: the second look waits for the first. */
const layers = [];

function loadLayer(number) {
  layers[number] ??= unpackLayer(picture.layers[number]);
  return layers[number];
}

async function unpackLayer(layer) {
  const planes = new Map();
  const plane = async (id) => {
    if (!planes.has(id)) planes.set(id, unpackPlane(byId(`plane-${id}`)));
    return planes.get(id);
  };
  const grids = layer.grids.map(async (grid) => ({
    ...grid,
    reference: await Promise.all(grid.planes.map(([id]) => plane(id))),
    test: await Promise.all(grid.planes.map(([, id]) => plane(id))),
  }));
  return { name: layer.name, channels: layer.channels, grids: await Promise.all(grids) };
}

/** The block's text goes: samples are not kept twice. */
async function unpackPlane(node) {
  const text = atob(node.textContent);
  node.textContent = "";
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  const inflated = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return unshuffle(new Uint8Array(await new Response(inflated).arrayBuffer()));
}

function unshuffle(shuffled) {
  const count = shuffled.length / 4;
  const bytes = new Uint8Array(shuffled.length);
  for (let place = 0; place < 4; place++) {
    for (let i = 0; i < count; i++) bytes[4 * i + place] = shuffled[place * count + i];
  }
  return new Float32Array(bytes.buffer);
}

/** The finest grid that covers a pixel, and the number of its block; null outside the image. */
function locate(layer, x, y) {
  if (x < 0 || y < 0 || x >= picture.width || y >= picture.height) return null;
  for (let i = layer.grids.length - 1; i >= 0; i--) {
    const grid = layer.grids[i];
    const [column, row] = [Math.floor((x - grid.x) / grid.block), Math.floor((y - grid.y) / grid.block)];
    if (column >= 0 && row >= 0 && column < grid.width && row < grid.height) {
      return { grid, index: row * grid.width + column };
    }
  }
  return null;
}
