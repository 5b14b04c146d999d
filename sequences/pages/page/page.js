"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const kindNames = { beauty: "full picture", indirect: "indirect light" };

// ---- numbers for people

function number(value, digits = 3) {
  if (value === null || value === undefined) return "–";
  if (value !== 0 && Math.abs(value) < 0.001) return value.toExponential(1);
  const places = Math.abs(value) >= 1 ? Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(value)))) : digits;
  return value.toLocaleString("en-US", { maximumFractionDigits: places });
}

function mean(values) {
  const known = values.filter((v) => v !== null);
  return known.length ? known.reduce((a, b) => a + b, 0) / known.length : null;
}

// ---- player

const pictures = data.pictures;
const player = { shown: 0, kind: null, split: 0.5, playing: false, timer: 0, images: new Map() };

function image(uri) {
  if (!uri) return null;
  if (!player.images.has(uri)) {
    const loaded = new Image();
    loaded.addEventListener("load", draw);
    loaded.src = uri;
    player.images.set(uri, loaded);
  }
  return player.images.get(uri);
}

function layer(name, shown) {
  const of = pictures.kinds[player.kind];
  return image(of[name] && of[name][shown]);
}

function draw() {
  const canvas = byId("picture");
  const context = canvas.getContext("2d");
  const noisy = layer("noisy", player.shown);
  const denoised = layer("denoised", player.shown);
  const cut = noisy ? Math.round(player.split * canvas.width) : 0;
  if (denoised.complete) context.drawImage(denoised, 0, 0);
  if (noisy && noisy.complete && cut > 0) {
    context.drawImage(noisy, 0, 0, cut, canvas.height, 0, 0, cut, canvas.height);
  }
}

function show(shown) {
  player.shown = Math.max(0, Math.min(pictures.frames.length - 1, shown));
  const frame = pictures.frames[player.shown];
  byId("slider").value = player.shown;
  byId("slider").setAttribute("aria-valuetext", `frame ${frame}`);
  byId("frame-number").textContent = `frame ${frame}`;
  byId("picture").setAttribute("aria-label", `Frame ${frame}, ${kindNames[player.kind]}`);
  draw();
  // The next one decodes while this one is looked at.
  const next = (player.shown + 1) % pictures.frames.length;
  layer("noisy", next);
  layer("denoised", next);
  markFrame(frame);
}

function setSplit(split) {
  player.split = Math.max(0, Math.min(1, split));
  const percent = Math.round(player.split * 100);
  const divider = byId("divider");
  divider.style.left = `${player.split * 100}%`;
  divider.setAttribute("aria-valuenow", percent);
  divider.setAttribute("aria-valuetext", `${percent} % noisy`);
  draw();
}

function setPlaying(playing) {
  player.playing = playing && pictures.frames.length > 1;
  const button = byId("play");
  button.setAttribute("aria-label", player.playing ? "Pause" : "Play");
  button.querySelector("path").setAttribute("d", player.playing ? "M3 2h4v12H3zM9 2h4v12H9z" : "M4 2l10 6-10 6z");
  clearInterval(player.timer);
  if (player.playing) startTicking();
}

// Frames are due by the clock: a slow browser skips some and keeps the pace.
function startTicking() {
  const first = player.shown;
  const start = performance.now();
  player.timer = setInterval(() => {
    const due = (first + Math.floor(((performance.now() - start) / 1000) * pictures.fps)) % pictures.frames.length;
    if (due !== player.shown) show(due);
  }, 500 / pictures.fps);
}

function stepBy(count) {
  setPlaying(false);
  show(player.shown + count);
}

function onKey(event) {
  const inControl = event.target.closest("input, [role=slider]");
  if (event.altKey || event.ctrlKey || event.metaKey) return;
  if (event.key === " " && !event.target.closest("button, input[type=checkbox], input[type=radio]")) {
    setPlaying(!player.playing);
  } else if (event.key === "ArrowLeft" && !inControl) {
    stepBy(-1);
  } else if (event.key === "ArrowRight" && !inControl) {
    stepBy(1);
  } else {
    return;
  }
  event.preventDefault();
}

function wireDivider() {
  const stage = byId("stage");
  const follow = (event) => {
    const box = stage.getBoundingClientRect();
    setSplit((event.clientX - box.left) / box.width);
  };
  stage.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    stage.setPointerCapture(event.pointerId);
    byId("divider").focus({ preventScroll: true });
    event.preventDefault();
    follow(event);
  });
  stage.addEventListener("pointermove", (event) => {
    if (stage.hasPointerCapture(event.pointerId)) follow(event);
  });
  byId("divider").addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1 };
    if (!(event.key in moves)) return;
    setSplit(player.split + moves[event.key]);
    event.preventDefault();
  });
}

function wireKinds() {
  const kinds = Object.keys(pictures.kinds);
  player.kind = kinds[0];
  for (const input of document.querySelectorAll("input[name=kind]")) {
    input.parentElement.hidden = !kinds.includes(input.value);
    input.checked = input.value === player.kind;
    input.addEventListener("change", () => {
      player.kind = input.value;
      showSides();
      show(player.shown);
    });
  }
  byId("kinds").hidden = kinds.length < 2;
}

function showSides() {
  const hasNoisy = Boolean(pictures.kinds[player.kind].noisy);
  for (const id of ["divider", "tag-left", "tag-right"]) byId(id).hidden = !hasNoisy;
}

function startPlayer() {
  if (!pictures.frames.length) {
    for (const part of [byId("stage"), document.querySelector(".controls")]) part.hidden = true;
    byId("player-note").textContent = "No pictures: the run left no frames with color or indirect light.";
    return;
  }
  const canvas = byId("picture");
  canvas.width = pictures.width;
  canvas.height = pictures.height;
  byId("slider").max = pictures.frames.length - 1;
  byId("slider").disabled = byId("play").disabled = pictures.frames.length < 2;
  byId("player-note").textContent = pictures.note;
  byId("tag-right").textContent = `denoised (${data.method})`;
  wireKinds();
  wireDivider();
  byId("slider").addEventListener("input", (event) => {
    setPlaying(false);
    show(Number(event.target.value));
  });
  byId("play").addEventListener("click", () => setPlaying(!player.playing));
  document.addEventListener("keydown", onKey);
  showSides();
  setSplit(0.5);
  show(0);
}

// ---- tables

function addRow(table, cells, className) {
  const row = byId(table).querySelector("tbody").insertRow();
  if (className) row.className = className;
  cells.forEach((text, i) => {
    const cell = document.createElement(i ? "td" : "th");
    if (!i) cell.scope = "row";
    cell.textContent = text;
    row.append(cell);
  });
}

function fillTables() {
  byId("subtitle").textContent = data.subtitle;
  for (const [name, value] of data.summary) addRow("summary", [name, value]);
  let wall = 0, cpu = 0;
  for (const stage of data.stages) {
    const stageWall = mean(stage.wall_ms), stageCpu = mean(stage.cpu_ms);
    wall += stageWall || 0;
    cpu += stageCpu || 0;
    addRow("times", [stage.name, number(stageWall), number(stageCpu)]);
  }
  addRow("times", ["all", number(wall), number(cpu)], "total");
  for (const skip of data.skips) {
    const pixels = mean(skip.pixels);
    addRow("skips", [skip.name, number(Math.round(pixels)), `${number((100 * pixels) / data.pixels)} %`]);
  }
}

// ---- plots

const plots = [];
const svgName = "http://www.w3.org/2000/svg";

function svg(name, attributes, text) {
  const node = document.createElementNS(svgName, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  return node;
}

// Round steps of 1, 2 or 5 times a power of ten; about `count` of them up to `top`.
function niceStep(top, count) {
  const raw = top / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((m) => m * power >= raw);
}

function axes(plot, frames) {
  const { width, height, left, right, top, bottom } = plot;
  plot.svg.replaceChildren();
  const step = niceStep(plot.max, 4);
  plot.max = Math.ceil(plot.max / step - 1e-9) * step;
  plot.y = (value) => height - bottom - (value / plot.max) * (height - top - bottom);
  plot.pitch = (width - left - right) / frames.length;
  plot.x = (index) => left + (index + 0.5) * plot.pitch;
  for (let value = 0; value <= plot.max * 1.0001; value += step) {
    const y = plot.y(value);
    plot.svg.append(svg("line", { class: "grid", x1: left, x2: width - right, y1: y, y2: y }));
    plot.svg.append(svg("text", { x: left - 6, y: y + 4, "text-anchor": "end" }, number(value)));
  }
  const every = Math.max(1, Math.ceil(niceStep(frames.length, Math.max(1, Math.floor(width / 80)))));
  for (let i = 0; i < frames.length; i += every) {
    plot.svg.append(svg("text", { x: plot.x(i), y: height - bottom + 16, "text-anchor": "middle" }, frames[i]));
  }
  plot.svg.append(svg("text", { x: width - right, y: height - 2, "text-anchor": "end" }, "frame"));
}

function newPlot(id, label, paint, describe) {
  const host = byId(id);
  const plot = { host, paint, describe, left: 52, right: 10, top: 10, bottom: 34, height: 210 };
  plot.svg = host.appendChild(svg("svg", { role: "img", "aria-label": label }));
  plot.tip = host.appendChild(document.createElement("div"));
  plot.tip.className = "tip";
  plot.tip.hidden = true;
  const indexAt = (event) => {
    const x = event.clientX - plot.svg.getBoundingClientRect().left;
    return Math.max(0, Math.min(data.frames.length - 1, Math.floor((x - plot.left) / plot.pitch)));
  };
  plot.svg.addEventListener("pointermove", (event) => {
    const index = indexAt(event);
    plot.tip.hidden = false;
    plot.tip.textContent = `frame ${data.frames[index]}\n${describe(index)}`;
    const room = plot.width - plot.tip.offsetWidth;
    const x = plot.x(index) + 10;
    plot.tip.style.left = `${Math.max(0, x > room ? x - 20 - plot.tip.offsetWidth : x)}px`;
  });
  plot.svg.addEventListener("pointerleave", () => { plot.tip.hidden = true; });
  plot.svg.addEventListener("click", (event) => seek(data.frames[indexAt(event)]));
  plots.push(plot);
}

function seek(frame) {
  if (!pictures.frames.length) return;
  const distances = pictures.frames.map((shown) => Math.abs(shown - frame));
  setPlaying(false);
  show(distances.indexOf(Math.min(...distances)));
}

function paintPlot(plot) {
  plot.width = Math.max(240, plot.host.clientWidth);
  plot.svg.setAttribute("viewBox", `0 0 ${plot.width} ${plot.height}`);
  plot.paint(plot);
  plot.now = plot.svg.appendChild(svg("line", { class: "now", y1: plot.top, y2: plot.height - plot.bottom }));
}

function markFrame(frame) {
  const index = data.frames.indexOf(frame);
  for (const plot of plots) {
    if (!plot.now || index < 0) continue;
    plot.now.setAttribute("x1", plot.x(index));
    plot.now.setAttribute("x2", plot.x(index));
  }
}

function paintAll() {
  plots.forEach(paintPlot);
  if (pictures.frames.length) markFrame(pictures.frames[player.shown]);
}

const plottedStages = () =>
  data.stages.filter((stage) => byId("with-rendering").checked || !["source", "resample", "write"].includes(stage.name));

function paintTimes(plot) {
  const stages = plottedStages();
  const totals = data.frames.map((_, i) => stages.reduce((sum, s) => sum + (s.wall_ms[i] || 0), 0));
  plot.max = Math.max(...totals) || 1;
  axes(plot, data.frames);
  // Thin bars touch, so that no pattern of gaps shows.
  const bar = plot.pitch < 6 ? plot.pitch + 0.5 : Math.min(48, plot.pitch - 2);
  const bases = data.frames.map(() => 0);
  for (const stage of stages) {
    const outline = data.frames.map((_, i) => {
      const low = plot.y(bases[i]);
      bases[i] += stage.wall_ms[i] || 0;
      return `M${(plot.x(i) - bar / 2).toFixed(1)} ${low.toFixed(1)}h${bar.toFixed(1)}V${plot.y(bases[i]).toFixed(1)}h${(-bar).toFixed(1)}z`;
    });
    plot.svg.append(svg("path", { d: outline.join(""), "data-stage": stage.name, style: `fill: var(--${stage.name}, var(--soft))` }));
  }
}

function describeTimes(index) {
  const stages = plottedStages();
  const total = stages.reduce((sum, s) => sum + (s.wall_ms[index] || 0), 0);
  return [...stages.map((s) => `${s.name} ${number(s.wall_ms[index])} ms`), `all ${number(total)} ms`].join("\n");
}

// A curve with gaps where a frame has no value; a lone value is a dot. Cuts do not set the scale.
function paintCurve(plot, values) {
  const known = values.filter((v) => v !== null);
  const scaling = values.filter((v, i) => v !== null && !data.cut[i]);
  plot.max = Math.max(...(scaling.length ? scaling : known), 0) || 1;
  axes(plot, data.frames);
  let path = "";
  values.forEach((value, i) => {
    if (value === null) return;
    const joined = i > 0 && values[i - 1] !== null;
    const y = plot.y(Math.min(value, plot.max));
    path += `${joined ? "L" : "M"}${plot.x(i).toFixed(1)} ${y.toFixed(1)}`;
    if (values.length <= 60) plot.svg.append(svg("circle", { class: "dot", r: 3, cx: plot.x(i), cy: y }));
  });
  plot.svg.append(svg("path", { class: "curve", d: path }));
}

function startPlots() {
  for (const stage of data.stages) {
    const entry = byId("legend").appendChild(document.createElement("span"));
    const color = entry.appendChild(document.createElement("i"));
    color.style.background = `var(--${stage.name}, var(--soft))`;
    entry.append(stage.name);
  }
  const share = data.new_share.map((v) => (v === null ? null : 100 * v));
  newPlot("plot-time", "Time per stage over the frames, in milliseconds", paintTimes, describeTimes);
  newPlot("plot-new", "Share of new pixels over the frames, in percent", (p) => paintCurve(p, share), (i) => `${number(share[i])} %`);
  newPlot("plot-rank", "Mean rank over the frames", (p) => paintCurve(p, data.rank), (i) => `rank ${number(data.rank[i])}`);
  byId("with-rendering").addEventListener("change", paintAll);
  paintAll();
  addEventListener("resize", () => requestAnimationFrame(paintAll));
}

fillTables();
startPlots();
startPlayer();
