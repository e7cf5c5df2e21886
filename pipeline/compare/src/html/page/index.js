// The list of comparisons, in the order of the data, which is the worst first.

const { rows, heat_range: heatRange } = block("comparisons");

/** The address of a report. Each part of the path is escaped, because a name can contain any character. */
function address(link) {
  return link.split("/").map((part) => (part === ".." ? part : encodeURIComponent(part))).join("/");
}

/** The ratio of value and limit in words. JSON has `null` for infinity. */
const ratioText = (excess) => (excess === null ? "∞" : excess > 0 ? `${shortText(excess)}×` : "");

function small(source, words) {
  return source ? element("img", { src: source, alt: words, loading: "lazy" }) : "";
}

function line(row) {
  const link = element("a", { href: address(row.link) }, fileName(row.test) || row.link);
  const badge = element("span", { class: `badge ${row.pass ? "pass" : "fail"}` }, row.pass ? "PASS" : "FAIL");
  const names = element("div", { class: "names" }, element("div", {}, badge, " ", link), element("div", {}, row.verdict),
    element("div", { class: "small" }, `${row.test} against ${row.reference}`));
  const cells = [ratioText(row.excess), row.relmse === null ? "not finite" : shortText(row.relmse)];
  return element("tr", { class: row.pass ? "pass" : "fail" },
    element("td", {}, small(row.thumbnails.test, "test image")), element("td", {}, small(row.thumbnails.heat, "error")),
    element("th", { scope: "row" }, names), ...cells.map((text) => element("td", {}, text)));
}

function show() {
  const [failedOnly, wanted] = [byId("failed-only").checked, byId("search").value.toLowerCase()];
  const shown = rows.filter((row) => (!failedOnly || !row.pass) && `${row.test} ${row.reference}`.toLowerCase().includes(wanted));
  byId("rows").tBodies[0].replaceChildren(...shown.map(line));
}

function beginIndex() {
  const failed = rows.filter(({ pass }) => !pass).length;
  document.title = failed ? `FAIL ${failed} of ${rows.length}` : `PASS ${rows.length}`;
  byId("verdict").textContent = failed ? "FAIL" : "PASS";
  byId("verdict").classList.add(failed ? "fail" : "pass");
  byId("names").textContent = failed ? `${failed} of ${rows.length} comparisons failed` : `${rows.length} comparisons passed`;
  byId("note").textContent = `Comparisons that failed come first, by the ratio to their limit; the others follow by relMSE. The error is the largest of each block, of the channel that differs most, relative to the reference as in relMSE. Its scale is logarithmic: black is ${heatRange[0]} and less, white is ${heatRange[1]} and more; magenta is not finite. Each picture has a white of its own.`;
  const head = ["test", "error", "comparison", "beyond limit", "relMSE"].map((text) => element("th", { scope: "col" }, text));
  byId("rows").tHead.replaceChildren(element("tr", {}, ...head));
  byId("failed-only").addEventListener("change", show);
  byId("search").addEventListener("input", show);
  show();
}

beginIndex();
