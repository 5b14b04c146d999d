// What a plot says about the place under the pointer.

function frameUnder(plot, event) {
  const x = event.clientX - plot.svg.getBoundingClientRect().left;
  return plot.xs.at((x - box.left) / (plot.width - box.left - box.right));
}

function nearestPoint(plot, event) {
  const area = plot.svg.getBoundingClientRect();
  const x = event.clientX - area.left, y = event.clientY - area.top;
  let best = null, least = 40 ** 2;
  for (const p of plot.places) {
    const distance = (p.px - x) ** 2 + (p.py - y) ** 2;
    if (distance < least) [best, least] = [p, distance];
  }
  return best;
}

function frameText(plot, frame) {
  const points = plot.shown.map((series) => series.points.find((p) => p.x === frame)).filter(Boolean);
  const lines = points.map((p) => `${p.name} ${number(p.y)}`);
  if (plot.stacked) lines.push(`all ${number(Math.max(...points.map((p) => p.top)))}`);
  return [`frame ${frame}: ${plot.y.label}`, ...lines].join("\n");
}

function pointText(plot, p) {
  const first = p.label ? `${p.name}, ${p.label}` : p.name;
  return `${first}\n${plot.x.label}: ${number(p.x)}\n${plot.y.label}: ${number(p.y)}`;
}

// Beside (x, y), at the left or right of it, within the plot.
function placeTip(plot, x, y) {
  const { tip } = plot;
  const room = plot.width - tip.offsetWidth;
  const left = x + 12 > room ? x - 12 - tip.offsetWidth : x + 12;
  tip.style.left = `${Math.max(0, Math.min(room, left))}px`;
  tip.style.top = `${Math.max(0, Math.min(y - tip.offsetHeight - 10, box.height - tip.offsetHeight))}px`;
}

function showTip(plot, event) {
  if (!plot.xs) return;
  if (plot.frames.length) {
    const frame = frameUnder(plot, event);
    plot.tip.hidden = false;
    plot.tip.textContent = frameText(plot, frame);
    placeTip(plot, plot.toX(frame), 0);
    return;
  }
  const p = nearestPoint(plot, event);
  plot.tip.hidden = !p;
  if (!p) return;
  plot.tip.textContent = pointText(plot, p);
  placeTip(plot, p.px, p.py);
}

function addTip(plot) {
  plot.tip = add(plot.host, "div", undefined, "tip");
  plot.tip.hidden = true;
  plot.svg.addEventListener("pointermove", (event) => showTip(plot, event));
  plot.svg.addEventListener("pointerleave", () => { plot.tip.hidden = true; });
  plot.svg.addEventListener("click", (event) => {
    if (plot.frames.length && plot.xs) seek(frameUnder(plot, event));
  });
}
