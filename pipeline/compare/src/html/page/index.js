// Many comparisons, the worst first: the order is that of the data.

const { rows, heat_range: heatRange } = block("comparisons");

/** Each part of the way is escaped: a name can hold any character. */
function address(link) {
  return link.split("/").map((part) => (part === ".." ? part : encodeURIComponent(part))).join("/");
}

/** `null` is what JSON has for infinity. */
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
  byId("note").textContent = `First those that failed, by how far beyond a limit; then by relMSE. Error: of the channel that differs most, relative to the reference as in relMSE, the largest of each block; black is ${heatRange[0]} and less, white ${heatRange[1]} and more, equal steps for equal factors; magenta is not finite. Each picture has a white of its own.`;
  const head = ["test", "error", "comparison", "beyond limit", "relMSE"].map((text) => element("th", { scope: "col" }, text));
  byId("rows").tHead.replaceChildren(element("tr", {}, ...head));
  byId("failed-only").addEventListener("change", show);
  byId("search").addEventListener("input", show);
  show();
}

beginIndex();
