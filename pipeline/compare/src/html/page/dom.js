"use strict";
// Elements are made of text and never of markup, so that names from files cannot become code.

const byId = (id) => document.getElementById(id);

/** An element with listeners or attributes, and children that are nodes or strings. */
function element(tag, attributes = {}, ...children) {
  return furnish(document.createElement(tag), attributes, children);
}

/** An SVG element, made in the same way. */
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

/** The parsed JSON of the data block of this name. */
function block(id) {
  return JSON.parse(byId(id).textContent);
}

/** A table of strings or nodes. The first cell of a row is its heading. */
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
