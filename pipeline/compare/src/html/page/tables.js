// The numbers of the report. Keys that are unknown here appear under their own names.

const heading = (key) => key.replaceAll("_", " ");

/** The values of an object by `key` or `key key`, so that `max.pixel` is a column too. */
function flatten(object, skip = []) {
  const found = new Map();
  for (const [key, value] of Object.entries(object)) {
    if (skip.includes(key)) continue;
    if (value && typeof value === "object" && !Array.isArray(value)) {
      for (const [inner, text] of flatten(value)) found.set(`${key} ${inner}`, text);
    } else {
      found.set(key, value);
    }
  }
  return found;
}

/** A value of the report as text or as a table. */
function valueNode(value) {
  if (Array.isArray(value) && value.some((item) => item && typeof item === "object" && !Array.isArray(item))) {
    return objectTable(value.map((item) => flatten(item && typeof item === "object" ? item : { value: item })));
  }
  if (Array.isArray(value)) return value.map((item) => (Array.isArray(item) ? `(${item.map(shortText).join(", ")})` : valueText(item))).join(", ");
  if (value && typeof value === "object") {
    return table(["", ""], [...flatten(value)].map(([key, inner]) => ({ cells: [heading(key), valueNode(inner)] })));
  }
  return valueText(value);
}

function valueText(value) {
  if (typeof value === "boolean") return value ? "yes" : "no";
  return typeof value === "string" ? value : shortText(value);
}

/** A table with a row for each map, and a column for each key of any map. */
function objectTable(rows, attributes = () => ({})) {
  const keys = [...new Set(rows.flatMap((row) => [...row.keys()]))];
  const cell = (row, key) => (row.has(key) ? valueCell(key, row.get(key)) : "");
  return table(keys.map(heading), rows.map((row, i) => ({ ...attributes(i), cells: keys.map((key) => cell(row, key)) })));
}

/** A value of the report; the sign of a bias is always written. */
function valueCell(key, value) {
  return key === "bias" && typeof value === "number" ? signedText(value) : valueNode(value);
}

function showGates() {
  const rows = report.gates.map(({ ok, gate, layer, channel, value, limit, ...more }) => new Map(Object.entries({
    gate, result: ok ? "pass" : "FAIL", layer, channel: channel ?? "", value, limit,
    "value / limit": typeof value === "number" && limit > 0 ? value / limit : "", ...more,
  })));
  const node = rows.length ? objectTable(rows, (i) => ({ class: report.gates[i].ok ? "pass" : "fail" })) : "No gate was given, so that only the finiteness of the values is judged.";
  byId("gates").replaceChildren(node);
}

function showMetrics() {
  const rows = report.layers.flatMap((layer, number) => {
    const channels = layer.channels.length > 1 ? layer.channels : [];
    return [[layer, number, true], ...channels.map((channel) => [channel, number, false])];
  });
  const maps = rows.map(([entry]) => flatten(entry, ["name", "channels"]));
  const keys = [...new Set(maps.flatMap((map) => [...map.keys()]))];
  const cells = rows.map(([entry, number, isLayer], i) => {
    const name = isLayer ? element("button", { type: "button", click: () => chooseLayer(number) }, entry.name) : entry.name;
    return { class: isLayer ? "layer" : "channel", cells: [name, ...keys.map((key) => (maps[i].has(key) ? valueCell(key, maps[i].get(key)) : ""))] };
  });
  byId("metrics").replaceChildren(table(["layer", ...keys.map(heading)], cells));
  const epsilon = report.relmse_epsilon === undefined ? "" : `relMSE is the mean of (test − reference)² / (reference² + ${shortText(report.relmse_epsilon)}). `;
  const { reference, test } = report.nonfinite ?? {};
  byId("metrics-note").textContent = epsilon + (report.nonfinite ? `Not finite: ${reference} samples of the reference, ${test} of the test image.` : "");
}

const SHOWN_ELSEWHERE = ["schema", "width", "height", "layers", "gates", "judged", "pass", "reference", "test", "verdict", "nonfinite", "relmse_epsilon"];

function showOther() {
  const entries = Object.entries(report).filter(([key]) => !SHOWN_ELSEWHERE.includes(key));
  byId("other-section").hidden = entries.length === 0;
  byId("other").replaceChildren(table(["", ""], entries.map(([key, value]) => ({ cells: [heading(key), valueNode(value)] }))));
}

/** Shows the attributes; those that differ come first. */
function showAttributes() {
  const { attributes } = picture;
  byId("attributes-section").hidden = attributes.length === 0;
  const differs = ({ reference, test }) => reference !== test;
  const sorted = [...attributes].sort((a, b) => differs(b) - differs(a));
  const rows = sorted.map((entry) => ({ class: differs(entry) ? "differs" : "", cells: [entry.name, entry.reference ?? "—", differs(entry) ? entry.test ?? "—" : "the same"] }));
  byId("attributes").replaceChildren(table(["attribute", "reference", "test"], rows));
}

function showHead() {
  const names = [report.test, report.reference].map((path) => fileName(path ?? ""));
  document.title = `${report.pass ? "PASS" : "FAIL"} ${names[0]}`;
  byId("verdict").textContent = report.pass ? "PASS" : "FAIL";
  byId("verdict").classList.add(report.pass ? "pass" : "fail");
  byId("names").textContent = names[0];
  const window = picture.window.some((coordinate) => coordinate !== 0) ? `, from ${picture.window.join(", ")}` : "";
  byId("facts").replaceChildren(
    element("span", {}, report.verdict ?? ""),
    element("span", {}, `test ${report.test}`), element("span", {}, `reference ${report.reference}`),
    element("span", {}, `${picture.width} × ${picture.height} pixels${window}`));
  byId("messages").replaceChildren(...picture.notes.map((text) => element("p", { class: "note" }, text)));
}
