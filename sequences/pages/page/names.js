// Colors, markers and the legend. A name looks the same wherever it stands.

const hidden = new Set();
const colorCount = 12;
const foreground = data.names.filter((name) => !data.background.names.includes(name));

function color(name) {
  const gray = data.background.names.indexOf(name);
  if (gray >= 0) return `var(--gray-${gray % 4})`;
  const index = foreground.indexOf(name);
  return index < 0 ? "var(--mark)" : `var(--name-${index % colorCount})`;
}

// Four shapes, so that a reader who cannot tell the colors apart can tell the names apart.
function shape(name, x, y, r) {
  const fill = { style: `fill: ${color(name)}`, "data-name": name };
  const index = Math.max(0, data.names.indexOf(name));
  const kind = (index + Math.floor(index / colorCount)) % 4;
  if (kind === 0) return svg("circle", { cx: x, cy: y, r, ...fill });
  if (kind === 1) return svg("rect", { x: x - 0.9 * r, y: y - 0.9 * r, width: 1.8 * r, height: 1.8 * r, ...fill });
  const triangle = `M${x} ${y - 1.25 * r}l${1.2 * r} ${2.1 * r}h${-2.4 * r}z`;
  const diamond = `M${x} ${y - 1.4 * r}l${1.4 * r} ${1.4 * r}l${-1.4 * r} ${1.4 * r}l${-1.4 * r} ${-1.4 * r}z`;
  return svg("path", { d: kind === 2 ? triangle : diamond, ...fill });
}

// A name, with its marker if it has one.
function addName(parent, name) {
  if (data.names.includes(name)) {
    const icon = svg("svg", { class: "marker", viewBox: "0 0 14 14", "aria-hidden": "true" });
    icon.append(shape(name, 7, 7, 5));
    parent.append(icon);
  }
  parent.append(name);
}

// ---- the legend

function addNameButton(legend, name) {
  const button = add(legend, "button");
  button.type = "button";
  addName(button, name);
  button.addEventListener("click", () => {
    if (!hidden.delete(name)) hidden.add(name);
    showHidden(legend);
    paintAll();
  });
}

function addBackgroundBox(legend) {
  const { label, names } = data.background;
  const element = add(legend, "label", undefined, "background");
  const box = add(element, "input");
  box.type = "checkbox";
  box.addEventListener("change", () => {
    for (const name of names) {
      if (box.checked) hidden.delete(name);
      else hidden.add(name);
    }
    showHidden(legend);
    paintAll();
  });
  element.append(` ${label} (${names.join(", ")})`);
}

function showHidden(legend) {
  legend.querySelectorAll("button").forEach((button, i) => {
    button.setAttribute("aria-pressed", String(!hidden.has(data.names[i])));
  });
  const box = legend.querySelector("input");
  if (box) {
    const count = data.background.names.filter((name) => hidden.has(name)).length;
    box.checked = count === 0;
    box.indeterminate = count > 0 && count < data.background.names.length;
  }
}

// On top of the page, or in the only plot that needs it.
function addLegend() {
  if (!data.names.length) return;
  const users = plots.filter((plot) => plot.series.some((series) => data.names.includes(series.name)));
  const legend = document.createElement("div");
  legend.id = "legend";
  legend.setAttribute("role", "group");
  legend.setAttribute("aria-label", "Legend: press a name to hide it in the plots or to show it again");
  data.names.forEach((name) => addNameButton(legend, name));
  if (data.background.names.length) addBackgroundBox(legend);
  if (users.length === 1) {
    users[0].host.before(legend);
  } else {
    legend.className = "top";
    byId("sections").before(legend);
  }
  showHidden(legend);
}
