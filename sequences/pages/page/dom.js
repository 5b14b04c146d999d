"use strict";
// What all other scripts use: the data of the page, and helpers to build elements.

const byId = (id) => document.getElementById(id);
const data = JSON.parse(byId("data").textContent);

// The frame and the kind of picture in view, the same in all galleries and plots.
const view = { frame: null, kind: 0 };

function add(parent, tag, text, className) {
  const node = parent.appendChild(document.createElement(tag));
  if (text !== undefined) node.textContent = text;
  if (className) node.className = className;
  return node;
}

function svg(name, attributes, text) {
  const node = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  return node;
}

function addCard(parent, title) {
  const card = add(parent, "div", undefined, "card");
  if (title) add(card, "h3", title);
  return card;
}

// Three significant digits, or all digits before the decimal point.
function number(value) {
  if (value === null || value === undefined) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 0.001 || size >= 1e7)) return value.toExponential(2).replace(/\.?0+e/, "e");
  const places = size >= 1 ? Math.max(0, 2 - Math.floor(Math.log10(size))) : 3 - Math.ceil(Math.log10(size || 1));
  return value.toLocaleString("en-US", { maximumFractionDigits: places });
}
