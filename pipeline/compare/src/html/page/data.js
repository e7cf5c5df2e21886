// The samples are float32, byte-shuffled, deflated and in base64. Each layer is unpacked when it is first shown.

const report = block("report");
const picture = block("picture");

/** The promises of the layers, by number, so that no layer is unpacked twice. */
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

/** Unpacks a plane, and removes the text of its block, so that the samples are not kept twice. */
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
  for (let byte = 0; byte < 4; byte++) {
    for (let i = 0; i < count; i++) bytes[4 * i + byte] = shuffled[byte * count + i];
  }
  return new Float32Array(bytes.buffer);
}

/** The finest grid that covers a pixel and the index of its block, or null outside the image. */
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
