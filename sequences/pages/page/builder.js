"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const hidden = new Set();
const view = { frame: null, kind: 0 };
const plots = [];
const galleries = [];

// ---- small things

function add(parent, tag, text, className) {
  const node = parent.appendChild(document.createElement(tag));
  if (text !== undefined) node.textContent = text;
  if (className) node.className = className;
  return node;
}

const svgName = "http://www.w3.org/2000/svg";

function svg(name, attributes, text) {
  const node = document.createElementNS(svgName, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  return node;
}

function number(value) {
  if (value === null || value === undefined) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size < 0.001 || size >= 1e6)) return value.toExponential(2).replace(/\.?0+e/, "e");
  const places = size >= 1 ? Math.max(0, 2 - Math.floor(Math.log10(size))) : 3 - Math.max(-3, Math.ceil(Math.log10(size || 1)));
  return value.toLocaleString("en-US", { minimumFractionDigits: 0, maximumFractionDigits: places });
}

// ---- colors and markers, by name

const color = (name) => {
  const index = data.names.indexOf(name);
  return index < 0 ? "var(--soft)" : `var(--name-${index % 10})`;
};

// Four shapes, so that colors are not all there is to tell names by.
function shape(name, x, y, r) {
  const fill = { style: `fill: ${color(name)}`, "data-name": name };
  const kind = Math.max(0, data.names.indexOf(name)) % 4;
  if (kind === 0) return svg("circle", { cx: x, cy: y, r, ...fill });
  if (kind === 1) return svg("rect", { x: x - 0.9 * r, y: y - 0.9 * r, width: 1.8 * r, height: 1.8 * r, ...fill });
  const d = kind === 2 ? `M${x} ${y - 1.25 * r}l${1.2 * r} ${2.1 * r}h${-2.4 * r}z` : `M${x} ${y - 1.4 * r}l${1.4 * r} ${1.4 * r}l${-1.4 * r} ${1.4 * r}l${-1.4 * r} ${-1.4 * r}z`;
  return svg("path", { d, ...fill });
}

function marker(name) {
  const icon = svg("svg", { class: "marker", viewBox: "0 0 14 14", "aria-hidden": "true" });
  icon.append(shape(name, 7, 7, 5));
  return icon;
}

function startLegend() {
  for (const name of data.names) {
    const button = add(byId("legend"), "button");
    button.type = "button";
    button.setAttribute("aria-pressed", "true");
    button.append(marker(name), name);
    button.addEventListener("click", () => {
      if (!hidden.delete(name)) hidden.add(name);
      button.setAttribute("aria-pressed", String(!hidden.has(name)));
      paintAll();
    });
  }
  byId("legend").hidden = data.names.length === 0;
}

// ---- axes

// Round steps of 1, 2 or 5 times a power of ten, about `count` of them over `span`.
function niceStep(span, count) {
  const raw = span / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((m) => m * power >= raw * 0.999);
}

function linearScale(low, high, count, least = 0) {
  if (low === high) [low, high] = [low - 0.5, high + 0.5];
  const step = Math.max(least, niceStep(high - low, count));
  const ticks = [];
  // Decimal places of the step, so that sums of tenths look like tenths.
  const places = Math.max(0, -Math.floor(Math.log10(step)));
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1) ticks.push(Number((i * step).toFixed(places)));
  return { share: (v) => (v - low) / (high - low), ticks };
}

// Ticks at 1, 2 and 5 times powers of ten over a few decades, at every n-th power over many.
function logScale(low, high, count) {
  const from = Math.log10(low) - 0.06, to = Math.log10(high) + 0.06;
  const decades = to - from;
  const factors = decades * 3 <= count * 1.5 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil(decades / count));
  let ticks = [];
  for (let power = Math.floor(from); power <= Math.ceil(to); power += 1) {
    if (power % every) continue;
    ticks.push(...factors.map((f) => Number(`${f}e${power}`)));
  }
  const inside = (all) => all.filter((v) => Math.log10(v) >= from && Math.log10(v) <= to);
  // Within one decade there may be too few of these: then round steps.
  if (inside(ticks).length < 3) ticks = linearScale(10 ** from, 10 ** to, count).ticks.filter((v) => v > 0);
  return { share: (v) => (Math.log10(v) - from) / decades, ticks: inside(ticks) };
}

// `least` is the smallest step between ticks: there are no halves of frames.
function scale(axis, values, count, least = 0) {
  if (!values.length) return null;
  const low = Math.min(...values), high = Math.max(...values);
  return axis.log ? logScale(low, high, count) : linearScale(low, high, count, least);
}

// ---- plots

const box = { left: 62, right: 14, top: 12, bottom: 46, height: 300 };

function shownSeries(plot) {
  const fits = (p) => (!plot.x.log || p.x > 0) && (!plot.y.log || p.y > 0);
  return plot.series.filter((s) => !hidden.has(s.name)).map((s) => ({ name: s.name, points: s.points.filter(fits) }));
}

function paintAxes(plot, width) {
  const right = width - box.right, bottom = box.height - box.bottom;
  for (const value of plot.ys.ticks) {
    const y = plot.toY(value);
    plot.svg.append(svg("line", { class: "grid", x1: box.left, x2: right, y1: y, y2: y }));
    plot.svg.append(svg("text", { x: box.left - 6, y: y + 4, "text-anchor": "end" }, number(value)));
  }
  for (const value of plot.xs.ticks) {
    const x = plot.toX(value);
    plot.svg.append(svg("line", { class: "grid", x1: x, x2: x, y1: box.top, y2: bottom }));
    plot.svg.append(svg("text", { x, y: bottom + 16, "text-anchor": "middle" }, plot.frames ? value : number(value)));
  }
  plot.svg.append(svg("rect", { class: "frame", x: box.left, y: box.top, width: right - box.left, height: bottom - box.top }));
  plot.svg.append(svg("text", { class: "axis", x: (box.left + right) / 2, y: box.height - 8, "text-anchor": "middle" }, plot.x.label));
  const middle = (box.top + bottom) / 2;
  plot.svg.append(svg("text", { class: "axis", x: 12, y: middle, "text-anchor": "middle", transform: `rotate(-90 12 ${middle})` }, plot.y.label));
}

function paintSeries(plot, series) {
  const places = series.points.map((p) => ({ ...p, name: series.name, px: plot.toX(p.x), py: plot.toY(p.y) }));
  if (!places.length) return;
  const d = places.map((p, i) => `${i ? "L" : "M"}${p.px.toFixed(1)} ${p.py.toFixed(1)}`).join("");
  plot.svg.append(svg("path", { class: "curve", d, style: `stroke: ${color(series.name)}`, "data-name": series.name }));
  for (const p of places) {
    if (!plot.frames || places.length <= 40) plot.svg.append(shape(series.name, p.px, p.py, plot.frames ? 2.5 : 4.5));
    if (p.front) plot.svg.append(svg("circle", { class: "ring", cx: p.px, cy: p.py, r: 8.5, style: `stroke: ${color(series.name)}` }));
  }
  plot.places.push(...places);
}

function paint(plot) {
  const width = Math.max(260, plot.host.clientWidth);
  plot.svg.setAttribute("viewBox", `0 0 ${width} ${box.height}`);
  plot.svg.replaceChildren();
  plot.places = [];
  const series = shownSeries(plot);
  const points = series.flatMap((s) => s.points);
  plot.xs = scale(plot.x, points.map((p) => p.x), Math.floor((width - box.left) / 70), plot.frames ? 1 : 0);
  plot.ys = scale(plot.y, points.map((p) => p.y), 5);
  if (!points.length) {
    plot.svg.append(svg("text", { x: width / 2, y: box.height / 2, "text-anchor": "middle" }, "nothing to show"));
    return;
  }
  plot.toX = (v) => box.left + plot.xs.share(v) * (width - box.left - box.right);
  plot.toY = (v) => box.height - box.bottom - plot.ys.share(v) * (box.height - box.top - box.bottom);
  paintAxes(plot, width);
  // The first name is drawn last, above all others.
  for (const one of [...series].reverse()) paintSeries(plot, one);
  if (plot.frames) plot.now = plot.svg.appendChild(svg("line", { class: "now", y1: box.top, y2: box.height - box.bottom }));
  markFrame(plot);
}

function markFrame(plot) {
  if (!plot.now || view.frame === null || !plot.xs) return;
  plot.now.setAttribute("x1", plot.toX(view.frame));
  plot.now.setAttribute("x2", plot.toX(view.frame));
}

function nearest(plot, event) {
  const area = plot.svg.getBoundingClientRect();
  const x = event.clientX - area.left, y = event.clientY - area.top;
  let best = null, least = 40 ** 2;
  for (const p of plot.places) {
    const distance = (p.px - x) ** 2 + (p.py - y) ** 2;
    if (distance < least) [best, least] = [p, distance];
  }
  return best;
}

function showTip(plot, event) {
  const p = nearest(plot, event);
  plot.tip.hidden = !p;
  if (!p) return;
  const first = p.label ? `${p.name}, ${p.label}` : p.name;
  plot.tip.textContent = `${first}\n${plot.x.label}: ${plot.frames ? p.x : number(p.x)}\n${plot.y.label}: ${number(p.y)}`;
  const room = plot.host.clientWidth - plot.tip.offsetWidth;
  plot.tip.style.left = `${Math.max(0, Math.min(room, p.px + 12))}px`;
  plot.tip.style.top = `${Math.max(0, p.py - plot.tip.offsetHeight - 10)}px`;
}

function addPlot(parent, given) {
  const card = add(parent, "div", undefined, "card");
  add(card, "h3", given.title);
  if (given.note) add(card, "p", given.note, "note");
  const plot = { ...given, places: [], host: add(card, "div", undefined, given.frames ? "plot seeks" : "plot") };
  plot.svg = plot.host.appendChild(svg("svg", { role: "img", "aria-label": `${given.title}: ${given.y.label} against ${given.x.label}` }));
  plot.tip = add(plot.host, "div", undefined, "tip");
  plot.tip.hidden = true;
  plot.svg.addEventListener("pointermove", (event) => showTip(plot, event));
  plot.svg.addEventListener("pointerleave", () => { plot.tip.hidden = true; });
  plot.svg.addEventListener("click", (event) => {
    const p = nearest(plot, event);
    if (plot.frames && p) seek(p.x);
  });
  plots.push(plot);
}

function paintAll() {
  plots.forEach(paint);
}

// ---- tables

function addTable(parent, table) {
  const card = add(parent, "div", undefined, "card");
  add(card, "h3", table.title);
  const element = add(add(card, "div", undefined, "scroll"), "table");
  const head = element.createTHead().insertRow();
  for (const title of [table.names, ...table.columns]) add(head, "th", title).scope = "col";
  const body = element.createTBody();
  for (const row of table.rows) {
    const line = body.insertRow();
    const name = add(line, "th");
    name.scope = "row";
    if (data.names.includes(row.name)) name.append(marker(row.name));
    name.append(row.name);
    row.cells.forEach((value, i) => {
      const words = typeof value === "string";
      add(line, "td", words ? value : number(value), words ? "words" : row.best[i] ? "best" : "");
    });
  }
  if (table.note) add(card, "p", table.note, "note");
}

// ---- galleries

function addKinds(controls, gallery) {
  const fields = add(controls, "fieldset");
  add(fields, "legend", "Show");
  gallery.radios = gallery.kinds.map((kind, i) => {
    const label = add(fields, "label");
    const radio = add(label, "input");
    radio.type = "radio";
    radio.name = `kind-${galleries.length}`;
    radio.addEventListener("change", () => {
      view.kind = i;
      galleries.forEach(showGallery);
    });
    label.append(` ${kind.name}`);
    return radio;
  });
}

function addGallery(parent, given) {
  const gallery = { ...given };
  const card = add(parent, "div", undefined, "card");
  add(card, "h3", gallery.title);
  const controls = add(card, "div", undefined, "controls");
  addKinds(controls, gallery);
  gallery.slider = add(controls, "input");
  Object.assign(gallery.slider, { type: "range", min: 0, max: gallery.frames.length - 1, step: 1, value: 0 });
  gallery.slider.setAttribute("aria-label", "Frame");
  gallery.slider.addEventListener("input", () => seek(gallery.frames[Number(gallery.slider.value)]));
  gallery.output = add(controls, "output");
  gallery.kindNote = add(card, "p", undefined, "note");
  gallery.ramp = add(card, "div", undefined, "ramp");
  const tiles = add(card, "div", undefined, "tiles");
  gallery.images = gallery.tiles.map((tile) => {
    const figure = add(tiles, "figure");
    const image = add(figure, "img");
    const caption = add(figure, "figcaption");
    if (data.names.includes(tile.name)) caption.append(marker(tile.name));
    caption.append(tile.name);
    return image;
  });
  if (gallery.note) add(card, "p", gallery.note, "note");
  galleries.push(gallery);
}

// The frame in view, or the one next to it that the gallery has.
function indexIn(gallery) {
  const distances = gallery.frames.map((frame) => Math.abs(frame - view.frame));
  return distances.indexOf(Math.min(...distances));
}

function showGallery(gallery) {
  const index = indexIn(gallery);
  const kind = Math.min(view.kind, gallery.kinds.length - 1);
  const { name, note, ramp, low, high } = gallery.kinds[kind];
  gallery.radios.forEach((radio, i) => { radio.checked = i === kind; });
  gallery.slider.value = index;
  gallery.slider.setAttribute("aria-valuetext", `frame ${gallery.frames[index]}`);
  gallery.output.textContent = `frame ${gallery.frames[index]}`;
  gallery.kindNote.textContent = note;
  gallery.ramp.hidden = ramp.length === 0;
  gallery.ramp.replaceChildren();
  if (ramp.length) {
    gallery.ramp.append(low);
    add(gallery.ramp, "i").style.background = `linear-gradient(90deg, ${ramp.join(", ")})`;
    gallery.ramp.append(high);
  }
  gallery.images.forEach((image, i) => {
    image.src = gallery.tiles[i].pictures[kind][index];
    image.alt = `${gallery.tiles[i].name}, ${name}, frame ${gallery.frames[index]}`;
  });
}

function seek(frame) {
  view.frame = frame;
  galleries.forEach(showGallery);
  plots.forEach(markFrame);
}

function onKey(event) {
  const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (!step || !galleries.length || event.altKey || event.ctrlKey || event.metaKey) return;
  if (event.target.closest && event.target.closest("input")) return;
  const { frames } = galleries[0];
  seek(frames[Math.max(0, Math.min(frames.length - 1, indexIn(galleries[0]) + step))]);
  event.preventDefault();
}

// ---- the page

function addSection(section, index) {
  const element = add(byId("sections"), "section");
  add(element, "h2", section.title).id = `section-${index}`;
  const link = add(byId("contents"), "a", section.title);
  link.href = `#section-${index}`;
  if (section.note) add(element, "p", section.note, "note");
  if (section.plots.length) {
    const grid = add(element, "div", undefined, section.plots.length % 2 ? "plots odd" : "plots");
    section.plots.forEach((plot) => addPlot(grid, plot));
  }
  section.tables.forEach((table) => addTable(element, table));
  section.galleries.filter((g) => g.frames.length).forEach((gallery) => addGallery(element, gallery));
}

byId("subtitle").textContent = data.subtitle;
startLegend();
data.sections.forEach(addSection);
byId("contents").hidden = data.sections.length < 2;
for (const [name, value] of data.summary) {
  add(byId("summary"), "dt", name);
  add(byId("summary"), "dd", value);
}
paintAll();
if (galleries.length) seek(galleries[0].frames[0]);
addEventListener("resize", () => requestAnimationFrame(paintAll));
document.addEventListener("keydown", onKey);
