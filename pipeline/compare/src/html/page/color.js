// Colors of values and errors.

const BINS = 4096;

/** The smallest linear values whose rounded sRGB code is 0, 1, ..., 255. */
const codeStarts = Float64Array.from({ length: 257 }, (_, code) => {
  const encoded = (code - 0.5) / 255;
  return encoded <= 0.04045 ? encoded / 12.92 : ((encoded + 0.055) / 1.055) ** 2.4;
});
codeStarts[256] = Infinity;

/** The code at the beginning of each of BINS equal parts of 0 to 1, where the search for a code begins. */
const binCodes = Uint8Array.from({ length: BINS + 1 }, (_, bin) => {
  let code = 0;
  while (codeStarts[code + 1] <= bin / BINS) code++;
  return code;
});

/** The sRGB code of a linear value, of which 1 is white: the exact curve, rounded. */
function srgbCode(linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 255;
  let code = binCodes[(linear * BINS) | 0];
  while (codeStarts[code + 1] <= linear) code++;
  return code;
}

/** The color at a part, 0 to 1, of a color map. */
function mapColor(map, part) {
  const position = Math.min(Math.max(part, 0), 1) * (map.length - 1);
  const index = Math.min(Math.floor(position), map.length - 2);
  return [0, 1, 2].map((i) => Math.round(map[index][i] + (map[index + 1][i] - map[index][i]) * (position - index)));
}

/** A color map in 1024 steps, with red, green and blue of each step one after the other. */
function mapTable(map) {
  return Uint8ClampedArray.from(Array.from({ length: 1025 }, (_, i) => mapColor(map, i / 1024)).flat());
}

const mapTables = { signed: mapTable(picture.colors.signed), absolute: mapTable(picture.colors.absolute) };

const cssColor = (rgb) => `rgb(${rgb.join(" ")})`;

/**
 * How a layer, or one channel of it, is shown: the numbers of the channels, and `light` for exposure and sRGB, or else a range
 * from `low` to `high` that is shown from black to white.
 */
function look(layer, channel) {
  const names = layer.channels;
  const find = (wanted) => wanted.map((name) => names.indexOf(name));
  const [colors, vector] = [find(["R", "G", "B"]), find(["X", "Y", "Z"])];
  const isColor = !colors.includes(-1);
  const all = channel < 0;
  if (all && isColor) return { channels: colors, light: true };
  const channels = all && !vector.includes(-1) ? vector : [Math.max(channel, 0)];
  if (["R", "G", "B", "Y"].includes(names[channels[0]])) return { channels, light: true };
  return { channels, light: false, ...range(layer, channels) };
}

/** The range of the finite values of both images. It is −1 to 1 for vectors of unit length. */
function range(layer, channels) {
  let [low, high] = [Infinity, -Infinity];
  const grid = layer.grids[0];
  for (const planes of [grid.reference, grid.test]) {
    for (const channel of channels) {
      for (const value of planes[channel]) {
        if (Number.isFinite(value)) [low, high] = [value < low ? value : low, value > high ? value : high];
      }
    }
  }
  if (low > high) return { low: 0, high: 1 };
  if (channels.length === 3 && Math.max(-low, high) <= 1.0001) return { low: -1, high: 1 };
  return { low, high: high > low ? high : low + 1 };
}
