// Appended to a copy of a page, after `wanted` and before the checks of its kind, which define
// checkPage().
const results = { passed: 0, failed: [] };

function check(what, condition) {
  if (condition) results.passed += 1;
  else results.failed.push(what);
}

const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const all = (selector, within = document) => [...within.querySelectorAll(selector)];
const press = (key, target = document.body) => target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
const outputs = () => all(".controls output").map((output) => output.textContent);
// Mean of red, green and blue of a computed color, in [0, 255].
const brightness = (rgb) => rgb.match(/\d+/g).slice(0, 3).reduce((sum, v) => sum + Number(v), 0) / 3;

// Of one pixel of a plot, given in the coordinates of the plot.
function pointAt(plot, type, x, y) {
  const area = plot.svg.getBoundingClientRect();
  plot.svg.dispatchEvent(new PointerEvent(type, { clientX: area.left + x, clientY: area.top + y, bubbles: true }));
}

function checkFile() {
  check("the page asks for no other file", performance.getEntriesByType("resource").every((entry) => entry.name.startsWith("data:")));
  check("the window has the wanted width", innerWidth === wanted.width);
  check("the page is not wider than the window", document.documentElement.scrollWidth <= innerWidth);
  check("nothing is left of the template", !document.documentElement.outerHTML.includes("{" + "{"));
  check("ids are unique", new Set(all("[id]").map((node) => node.id)).size === all("[id]").length);
  check("buttons and inputs have a name", all("button, input").every((node) => node.textContent || node.ariaLabel || node.labels?.length));
  const { backgroundColor, color: ink } = getComputedStyle(document.body);
  const [back, text] = [backgroundColor, ink].map(brightness);
  check("colors are those of the scheme", wanted.scheme === "dark" ? back < 50 && text > 200 : back > 200 && text < 50);
}

function checkTexts(plot) {
  const texts = all("text", plot.svg).map((text) => text.textContent);
  check(`${plot.title}: the axes have numbers`, texts.length >= 6 && texts.every((text) => text && !/NaN|undefined|Infinity/.test(text)));
  const boxes = all("text:not(.axis)", plot.svg).filter((t) => t.getAttribute("text-anchor") === "middle").map((t) => t.getBBox());
  check(`${plot.title}: labels do not touch`, boxes.every((b, i) => !i || b.x >= boxes[i - 1].x + boxes[i - 1].width));
  check(`${plot.title}: the axes name what they show`, [plot.x.label, plot.y.label].every((label) => label && texts.includes(label)));
}

function checkPlot(plot) {
  checkTexts(plot);
  const drawn = all("path.curve, path.bars", plot.svg);
  check(`${plot.title}: every series is drawn`, drawn.length === plot.series.length);
  const frame = plot.svg.querySelector("rect.frame").getBBox();
  const isInside = (b) => b.x >= frame.x - 1 && b.x + b.width <= frame.x + frame.width + 1 && b.y >= frame.y - 1 && b.y + b.height <= frame.y + frame.height + 1;
  check(`${plot.title}: it stays within the axes`, drawn.every((path) => isInside(path.getBBox())));
  check(`${plot.title}: its text is not scaled`, Math.abs(plot.svg.getBoundingClientRect().width - plot.width) < 1);
  check(`${plot.title}: it fits its card`, plot.svg.getBoundingClientRect().right <= plot.host.parentElement.getBoundingClientRect().right);
}

function checkTables() {
  const cells = all("td:not(.words)").map((cell) => cell.textContent);
  check("cells hold a number or a dash", cells.every((text) => /^(–|-?[\d.,]+(e[+-]?\d+)?)$/.test(text)));
  check("each row has all its cells", all("table").every((table) => new Set([...table.rows].map((row) => row.cells.length)).size === 1));
}

addEventListener("load", async () => {
  try {
    await wait(500);
    checkFile();
    check("all plots are there", all(".plot svg").length === data.sections.flatMap((section) => section.plots).length);
    plots.forEach(checkPlot);
    checkTables();
    await checkPage();
  } catch (error) {
    results.failed.push(`${error} ${error.stack}`);
  }
  for (const message of pageErrors) results.failed.push(`console: ${message}`);
  parent.postMessage(JSON.stringify(results), "*");
});
