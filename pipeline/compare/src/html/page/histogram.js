// The histogram of the signed errors of each channel.

/** The number of equal bins of the range. It is odd, so that zero is in the middle of a bin. Two more bins hold errors beyond it. */
const BINS_IN_RANGE = 61;

/** `{ limit, channels: [{ name, number, counts, notFinite }] }`. The first and last count are those of errors beyond ±limit. */
function errorHistogram() {
  const grid = state.data.grids[0];
  const numbers = shownChannels();
  const errors = (channel, i) => grid.test[channel][i] - grid.reference[channel][i];
  const length = grid.width * grid.height;
  let largest = 0;
  for (const channel of numbers) {
    for (let i = 0; i < length; i++) {
      const size = Math.abs(errors(channel, i));
      if (size > largest && size < Infinity) largest = size;
    }
  }
  const limit = histogramLimit(largest);
  const channels = numbers.map((number) => {
    const counts = new Array(BINS_IN_RANGE + 2).fill(0);
    let notFinite = 0;
    for (let i = 0; i < length; i++) {
      const error = errors(number, i);
      if (Number.isFinite(error)) counts[binOf(error, limit)]++;
      else notFinite++;
    }
    return { name: state.data.channels[number], number, counts, notFinite };
  });
  return { limit, channels };
}

/** The limit that holds all errors, or 4 times the 99th percentile if a few errors are far beyond it. */
function histogramLimit(largest) {
  const { p99 } = layerReport();
  return niceAbove(p99 > 0 && largest > 8 * p99 ? 4 * p99 : largest);
}

/** The index of the bin of an error. */
function binOf(error, limit) {
  if (error < -limit) return 0;
  if (error > limit) return BINS_IN_RANGE + 1;
  return 1 + Math.min(Math.floor(((error + limit) / (2 * limit)) * BINS_IN_RANGE), BINS_IN_RANGE - 1);
}

const PLOT = { width: 420, height: 210, left: 46, right: 10, top: 18, bottom: 36 };

function showHistogram() {
  const histogram = errorHistogram();
  const maxCount = Math.max(1, ...histogram.channels.flatMap(({ counts }) => counts));
  const decades = Math.max(1, Math.ceil(Math.log10(maxCount)));
  const inner = [PLOT.width - PLOT.left - PLOT.right, PLOT.height - PLOT.top - PLOT.bottom];
  // The axis begins half a decade below 1, so that a single sample is visible.
  const y = (count) => PLOT.top + inner[1] * (1 - (count > 0 ? (Math.log10(count) + 0.5) / (decades + 0.5) : 0));
  const x = (bin) => PLOT.left + (inner[0] * bin) / (BINS_IN_RANGE + 2);
  const svg = shape("svg", { viewBox: `0 0 ${PLOT.width} ${PLOT.height}`, role: "img", "aria-label": histogramWords(histogram) },
    ...axes(histogram.limit, decades, x, y), ...histogram.channels.flatMap((channel) => curve(channel, histogram.limit, x, y)), ...tips(histogram, x));
  byId("histogram").replaceChildren(svg);
  byId("histogram-note").replaceChildren(...means(histogram));
  if (byId("counts").open) showCounts(histogram);
}

function axes(limit, decades, x, y) {
  const [zero, base] = [x((BINS_IN_RANGE + 2) / 2), PLOT.height - PLOT.bottom];
  const nodes = [];
  for (let power = 0; power <= decades; power++) {
    nodes.push(shape("line", { class: "rule", x1: PLOT.left, x2: PLOT.width - PLOT.right, y1: y(10 ** power), y2: y(10 ** power) }));
    if (decades < 5 || power % 2 === 0) nodes.push(shape("text", { x: PLOT.left - 5, y: y(10 ** power) + 3.5, "text-anchor": "end" }, power < 4 ? String(10 ** power) : `1e${power}`));
  }
  nodes.push(shape("line", { class: "axis", x1: PLOT.left, x2: PLOT.width - PLOT.right, y1: base, y2: base }));
  nodes.push(shape("line", { class: "zero", x1: zero, x2: zero, y1: PLOT.top - 4, y2: base + 4 }));
  const label = (left, text, anchor) => shape("text", { x: left, y: base + 15, "text-anchor": anchor }, text);
  nodes.push(label(x(1), `−${shortText(limit)}`, "middle"), label(zero, "0", "middle"), label(x(BINS_IN_RANGE + 1), `+${shortText(limit)}`, "middle"));
  nodes.push(shape("text", { x: zero, y: PLOT.height - 5, "text-anchor": "middle" }, "test − reference"));
  nodes.push(shape("text", { x: 3, y: 11 }, "samples"));
  return nodes;
}

/** The counts as steps, and the mean error of the report as a dashed line. */
function curve({ name, number, counts }, limit, x, y) {
  const steps = counts.map((count, i) => `${i ? "L" : "M"}${x(i)} ${y(count)}L${x(i + 1)} ${y(count)}`).join("");
  const color = `channel-${"RXGYBZ".includes(name) ? name : "other"}`;
  const nodes = [shape("path", { class: `curve ${color}`, d: steps })];
  const mean = meanError(number);
  if (Number.isFinite(mean)) {
    const left = x(1 + BINS_IN_RANGE * (0.5 + Math.min(Math.max(mean / limit, -1), 1) / 2));
    nodes.push(shape("line", { class: `mean ${color}`, x1: left, x2: left, y1: PLOT.top, y2: PLOT.height - PLOT.bottom }));
  }
  return nodes;
}

/** The mean error of a channel by the report, or NaN if the report has none. */
function meanError(number) {
  const { mean_reference, mean_test } = layerReport().channels[number];
  return typeof mean_reference === "number" && typeof mean_test === "number" ? mean_test - mean_reference : NaN;
}

/** The range of a bin in words. */
function binWords(i, limit) {
  const edge = (bin) => signedText(Number(((2 * bin - BINS_IN_RANGE) / BINS_IN_RANGE * limit).toPrecision(3)));
  if (i === 0) return `below −${shortText(limit)}`;
  if (i === BINS_IN_RANGE + 1) return `above +${shortText(limit)}`;
  return `${edge(i - 1)} to ${edge(i)}`;
}

function tips({ limit, channels }, x) {
  return Array.from({ length: BINS_IN_RANGE + 2 }, (_, i) => {
    const text = `${binWords(i, limit)}\n${channels.map(({ name, counts }) => `${name}: ${counts[i]}`).join("\n")}`;
    return shape("rect", { class: "tip", x: x(i), y: PLOT.top, width: x(1) - x(0), height: PLOT.height - PLOT.top - PLOT.bottom }, shape("title", {}, text));
  });
}

function means({ channels }) {
  const entries = channels.map(({ name, number, notFinite }) => {
    const mean = meanError(number);
    const text = `${name} mean ${Number.isFinite(mean) ? signedText(mean) : "not finite"}${notFinite ? `, ${notFinite} not finite` : ""}`;
    return element("span", { class: `entry key channel-${"RXGYBZ".includes(name) ? name : "other"}` }, text);
  });
  const { block } = state.data.grids[0];
  return block > 1 ? [...entries, element("span", { class: "entry" }, `of means of ${block} × ${block} pixels`)] : entries;
}

function histogramWords({ limit, channels }) {
  const sides = ({ name, counts }) => {
    const sum = (from, to) => counts.slice(from, to).reduce((a, b) => a + b, 0);
    const middle = (BINS_IN_RANGE + 1) / 2;
    return `${name}: ${sum(0, middle)} below, ${counts[middle]} around, ${sum(middle + 1)} above zero`;
  };
  return `Histogram of signed errors from −${shortText(limit)} to ${shortText(limit)}. ${channels.map(sides).join("; ")}`;
}

function showCounts({ limit, channels } = errorHistogram()) {
  const rows = Array.from({ length: BINS_IN_RANGE + 2 }, (_, i) => ({ cells: [binWords(i, limit), ...channels.map(({ counts }) => String(counts[i]))] }));
  rows.push({ cells: ["not finite", ...channels.map(({ notFinite }) => String(notFinite))] });
  byId("counts").querySelector("div").replaceChildren(table(["error", ...channels.map(({ name }) => name)], rows));
}

byId("counts").addEventListener("toggle", () => state.data && byId("counts").open && showCounts());
