// The state: what is shown, and where.

const VIEWS = [
  { id: "split", name: "Split" },
  { id: "flicker", name: "Flicker" },
  { id: "side", name: "Side by side" },
  { id: "signed", name: "Signed error" },
  { id: "absolute", name: "Absolute error" },
];

const state = {
  view: "split",
  /** The numbers of the layer in `picture.layers` and of the channel; −1 is all channels. */
  layer: 0,
  channel: -1,
  /** The samples of the layer, once they are unpacked. */
  data: null,
  look: null,
  stops: 0,
  /** The error at the end of the color map, in units of the channel. */
  scale: 1,
  /** The image that flicker shows. */
  shown: "reference",
  split: 0.5,
  /** The number of screen pixels per image pixel, and the point of the image at the middle of the stage. */
  zoom: 1,
  center: [picture.width / 2, picture.height / 2],
  fitted: true,
  /** The column and row of the pixel that is read, from the top left of the image. */
  cursor: [Math.floor(picture.width / 2), Math.floor(picture.height / 2)],
};

/** The numbers of the layer that is shown. */
function layerReport() {
  return report.layers[state.layer];
}

/** The numbers of the channels whose errors are shown: all of the layer, or the chosen one. */
function shownChannels() {
  return state.channel < 0 ? state.data.channels.map((_, i) => i) : [state.channel];
}

/** The scale that holds 99 of 100 errors of the layer. It is from the report, which is about the whole image. */
function automaticScale() {
  const { p99, max } = layerReport();
  return niceAbove(p99 > 0 ? p99 : max && max.error);
}

/** The exposure at which 99 of 100 values of the reference are below white, in stops. */
function automaticStops() {
  if (!state.look.light) return 0;
  const grid = state.data.grids[0];
  const planes = state.look.channels.map((channel) => grid.reference[channel].filter(Number.isFinite));
  const sorted = new Float32Array(planes.reduce((sum, plane) => sum + plane.length, 0));
  planes.reduce((at, plane) => (sorted.set(plane, at), at + plane.length), 0);
  sorted.sort();
  const white = sorted[Math.max(Math.ceil(sorted.length * 0.99) - 1, 0)];
  return white > 0 ? Math.max(Math.min(Math.round(-4 * Math.log2(white)) / 4, 30), -30) : 0;
}
