"use strict";
// Elements are made of texts and never of markup: names from files cannot become code.

const byId = (id) => document.getElementById(id);

/** An element with properties or attributes, and children that are nodes or texts. */
function element(tag, attributes = {}, ...children) {
  return furnish(document.createElement(tag), attributes, children);
}

/** The same for drawings. */
function shape(tag, attributes = {}, ...children) {
  return furnish(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

function furnish(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") node.addEventListener(name, value);
    else if (value !== undefined && value !== false) node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children);
  return node;
}

/** The data block of this name. */
function block(id) {
  return JSON.parse(byId(id).textContent);
}

/** A table of texts or nodes; the first cell of a row is its heading. */
function table(head, rows) {
  const heading = element("tr", {}, ...head.map((text) => element("th", { scope: "col" }, text)));
  const body = rows.map(({ cells, ...attributes }) =>
    element("tr", attributes, ...cells.map((cell, i) => element(i ? "td" : "th", i ? {} : { scope: "row" }, cell))));
  return element("table", {}, element("thead", {}, heading), element("tbody", {}, ...body));
}

/** The last part of a path. */
function fileName(path) {
  return path.split(/[\\/]/).pop();
}
