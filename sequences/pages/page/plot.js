// Plots: lines or stacked bars, over frames or any other value.

const plots = [];
const box = { left: 72, right: 14, top: 12, bottom: 46, height: 300 };
const mostDots = 60;

// ---- what is shown

function pointsOf(plot, series) {
  const xs = plot.frames.length ? plot.frames : series.x;
  return xs.map((x, i) => ({
    name: series.name, x, y: x === null ? null : series.y[i],
    label: series.labels && series.labels[i], isOnFront: Boolean(series.front && series.front[i]),
  }));
}

// Points without y are gaps. A logarithmic axis has no place for values up to 0.
function shownSeries(plot) {
  const fits = (p) => p.y === null || ((!plot.x.log || p.x > 0) && (!plot.y.log || p.y > 0));
  return plot.series.filter((s) => !hidden.has(s.name)).map((s) => ({ name: s.name, points: pointsOf(plot, s).filter(fits) }));
}

// Bars stand on those of the series before: `base` is where a bar begins.
function stack(series) {
  const tops = new Map();
  for (const one of series) {
    for (const p of one.points) {
      p.base = tops.get(p.x) || 0;
      p.top = p.base + (p.y || 0);
      tops.set(p.x, p.top);
    }
  }
  return [...tops.values()];
}

function setScales(plot) {
  const points = plot.shown.flatMap((s) => s.points).filter((p) => p.y !== null);
  if (!points.length) return false;
  const count = Math.floor((plot.width - box.left) / 70);
  const onScale = points.filter((p) => !plot.off_scale.includes(p.x));
  const heights = plot.stacked ? stack(plot.shown) : (onScale.length ? onScale : points).map((p) => p.y);
  plot.xs = plot.frames.length ? frameScale(plot.frames, count) : valueScale(plot.x, points.map((p) => p.x), count);
  plot.ys = valueScale(plot.stacked ? { log: false, zero: true } : plot.y, heights, 5);
  plot.toX = (v) => box.left + plot.xs.share(v) * (plot.width - box.left - box.right);
  plot.toY = (v) => box.height - box.bottom - Math.min(1, plot.ys.share(v)) * (box.height - box.top - box.bottom);
  return true;
}

// ---- how it is drawn

function paintAxes(plot) {
  const right = plot.width - box.right, bottom = box.height - box.bottom;
  const put = (...given) => plot.svg.append(svg(...given));
  for (const value of plot.ys.ticks) {
    const y = plot.toY(value);
    put("line", { class: "grid", x1: box.left, x2: right, y1: y, y2: y });
    put("text", { x: box.left - 6, y: y + 4, "text-anchor": "end" }, number(value));
  }
  for (const value of plot.xs.ticks) {
    const x = plot.toX(value);
    put("line", { class: "grid", x1: x, x2: x, y1: box.top, y2: bottom });
    put("text", { x, y: bottom + 16, "text-anchor": "middle" }, plot.frames.length ? value : number(value));
  }
  put("rect", { class: "frame", x: box.left, y: box.top, width: right - box.left, height: bottom - box.top });
  put("text", { class: "axis", x: (box.left + right) / 2, y: box.height - 8, "text-anchor": "middle" }, plot.x.label);
  const middle = (box.top + bottom) / 2;
  put("text", { class: "axis", x: 12, y: middle, "text-anchor": "middle", transform: `rotate(-90 12 ${middle})` }, plot.y.label);
}

function paintLine(plot, series) {
  const { points } = series;
  const places = points.filter((p) => p.y !== null);
  let path = "";
  points.forEach((p, i) => {
    if (p.y === null) return;
    [p.px, p.py] = [plot.toX(p.x), plot.toY(p.y)];
    const isJoined = i > 0 && points[i - 1].y !== null;
    path += `${isJoined ? "L" : "M"}${p.px.toFixed(1)} ${p.py.toFixed(1)}`;
    const isAlone = !isJoined && (i + 1 === points.length || points[i + 1].y === null);
    if (!plot.frames.length || places.length <= mostDots || isAlone) {
      plot.svg.append(shape(p.name, p.px, p.py, plot.frames.length ? 2.5 : 4.5));
    }
    if (p.isOnFront) plot.svg.append(svg("circle", { class: "ring", cx: p.px, cy: p.py, r: 8.5, style: `stroke: ${color(p.name)}` }));
  });
  if (path) plot.svg.append(svg("path", { class: "curve", d: path, style: `stroke: ${color(series.name)}`, "data-name": series.name }));
  plot.places.push(...places);
}

function paintBars(plot, series) {
  const pitch = (plot.width - box.left - box.right) / plot.frames.length;
  // Narrow bars touch each other: gaps of a fraction of a pixel would make a pattern.
  const width = pitch < 6 ? pitch + 0.5 : Math.min(48, pitch - 2);
  const bar = (p) => `M${(plot.toX(p.x) - width / 2).toFixed(1)} ${plot.toY(p.base).toFixed(1)}h${width.toFixed(1)}V${plot.toY(p.top).toFixed(1)}h${(-width).toFixed(1)}z`;
  plot.svg.append(svg("path", { class: "bars", d: series.points.map(bar).join(""), style: `fill: ${color(series.name)}`, "data-name": series.name }));
}

function paint(plot) {
  plot.width = Math.max(260, plot.host.clientWidth);
  plot.svg.setAttribute("viewBox", `0 0 ${plot.width} ${box.height}`);
  plot.svg.replaceChildren();
  plot.places = [];
  plot.now = null;
  plot.shown = shownSeries(plot);
  if (!setScales(plot)) {
    plot.xs = null;
    plot.svg.append(svg("text", { x: plot.width / 2, y: box.height / 2, "text-anchor": "middle" }, "nothing to show"));
    return;
  }
  paintAxes(plot);
  if (plot.stacked) plot.shown.forEach((series) => paintBars(plot, series));
  // The first name is drawn last, above all others.
  else [...plot.shown].reverse().forEach((series) => paintLine(plot, series));
  if (plot.frames.length) plot.now = plot.svg.appendChild(svg("line", { class: "now", y1: box.top, y2: box.height - box.bottom }));
  markFrame(plot);
}

function paintAll() {
  plots.forEach(paint);
}

function markFrame(plot) {
  if (!plot.now) return;
  const isThere = plot.xs.has(view.frame);
  plot.now.style.display = isThere ? "" : "none";
  if (!isThere) return;
  plot.now.setAttribute("x1", plot.toX(view.frame));
  plot.now.setAttribute("x2", plot.toX(view.frame));
}

function addPlot(parent, given) {
  const card = addCard(parent, given.title);
  if (given.note) add(card, "p", given.note, "note");
  const plot = { ...given, places: [], host: add(card, "div", undefined, given.frames.length ? "plot seeks" : "plot") };
  plot.svg = plot.host.appendChild(svg("svg", { role: "img", "aria-label": `${given.title}: ${given.y.label} against ${given.x.label}` }));
  addTip(plot);
  plots.push(plot);
}
