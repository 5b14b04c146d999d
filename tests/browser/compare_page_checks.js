// Appended to a copy of the comparison page by compare_page_test.py.
const results = { passed: 0, failed: [] };

function check(what, condition) {
  if (condition) results.passed += 1;
  else results.failed.push(what);
}

const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const all = (selector, within = document) => [...within.querySelectorAll(selector)];
const press = (key) => document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
const firstSources = () => all(".tiles")[0] && all("img", all(".tiles")[0]).map((image) => image.src);
const outputs = () => all(".controls output").map((output) => output.textContent);

function checkPlots() {
  check("three plots a scene", plots.length === 6 && all(".plot svg").length === 6);
  for (const plot of plots) {
    const curves = all("path.curve", plot.svg);
    check(`${plot.title}: a curve for each name`, curves.length === data.names.length);
    check(`${plot.title}: curves have length`, curves.every((curve) => curve.getTotalLength() > 50));
    const frame = plot.svg.querySelector("rect.frame").getBBox();
    const inside = (b) => b.x >= frame.x - 1 && b.x + b.width <= frame.x + frame.width + 1 && b.y >= frame.y - 1 && b.y + b.height <= frame.y + frame.height + 1;
    check(`${plot.title}: curves stay within the axes`, curves.every((curve) => inside(curve.getBBox())));
    const texts = all("text", plot.svg).map((text) => text.textContent);
    check(`${plot.title}: axes have numbers`, texts.length >= 8 && texts.every((text) => text && !/NaN|undefined|Infinity/.test(text)));
    const boxes = all("text:not(.axis)", plot.svg).filter((t) => t.getAttribute("text-anchor") === "middle").map((t) => t.getBBox());
    check(`${plot.title}: labels do not touch`, boxes.every((b, i) => !i || b.x >= boxes[i - 1].x + boxes[i - 1].width));
  }
  check("axes name their units", plots[0].svg.textContent.includes("ms a frame") && plots[0].svg.textContent.includes("relMSE"));
  check("points on the front have rings", all("circle.ring", plots[0].svg).length >= 4);
  const points = plots[1].places.filter((p) => p.name === data.names[1]);
  check("what has no logarithm is left out", points.length === 2);
}

function checkNames() {
  const of = (name) => getComputedStyle(document.querySelector(`#legend [data-name="${name}"]`)).fill;
  for (const name of data.names) {
    const marks = all(`[data-name="${name}"]:not(path.curve)`);
    check(`${name}: one color everywhere`, marks.length > 10 && marks.every((mark) => getComputedStyle(mark).fill === of(name)));
    check(`${name}: curves have it too`, all(`path.curve[data-name="${name}"]`).every((curve) => getComputedStyle(curve).stroke === of(name)));
  }
  check("names differ in color", new Set(data.names.map(of)).size === data.names.length);
  const button = all("#legend button")[1];
  button.click();
  check("a name can be hidden", button.getAttribute("aria-pressed") === "false" && !plots[0].svg.querySelector(`[data-name="${data.names[1]}"]`));
  button.click();
  check("and shown again", Boolean(plots[0].svg.querySelector(`[data-name="${data.names[1]}"]`)));
}

function checkTables() {
  const tables = all("table");
  check("two tables a scene", tables.length === 4);
  check("a row for each name", tables[0].tBodies[0].rows.length === data.names.length);
  const best = all("td.best", tables[0]);
  check("the best is bold", best.length === 8 && best.every((cell) => Number(getComputedStyle(cell).fontWeight) >= 600));
  check("cells hold numbers or nothing", all("td").every((cell) => /^(–|-?[\d.,]+(e[+-]?\d+)?)$/.test(cell.textContent)));
  check("titles are text", all("section .note")[0].textContent === "A <made-up> room");
}

async function checkPictures() {
  check("a picture for each name and the reference", all("img", all(".tiles")[0]).length === data.names.length + 1);
  await wait(200);
  check("pictures are drawn", all(".tiles img").every((image) => image.complete && image.naturalWidth === 32));
  check("first frame at first", outputs().every((text) => text === "frame 4"));
  const before = firstSources();
  press("ArrowRight");
  check("right steps all galleries", outputs().every((text) => text === "frame 5"));
  check("all pictures follow", firstSources().every((source, i) => source !== before[i]));
  check("plots mark the frame", plots[1].now.getAttribute("x1") === String(plots[1].toX(5)));
  press("ArrowLeft");
  press("ArrowLeft");
  check("left stops at the first", outputs().every((text) => text === "frame 4"));
  const slider = document.querySelector("input[type=range]");
  slider.value = 2;
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  check("the slider seeks", outputs().every((text) => text === "frame 6"));
  check("pictures have no scale", all(".ramp").every((ramp) => getComputedStyle(ramp).display === "none"));
  const shown = firstSources();
  all("fieldset input")[1].click();
  check("heat maps are other pictures", firstSources().every((source, i) => source !== shown[i]));
  check("and have a scale", all(".ramp").every((ramp) => !ramp.hidden && ramp.querySelector("i").style.background.includes("gradient")));
  const place = plots[1].places.find((p) => p.x === 5);
  const area = plots[1].svg.getBoundingClientRect();
  const at = { clientX: area.left + place.px, clientY: area.top + place.py, bubbles: true };
  plots[1].svg.dispatchEvent(new PointerEvent("pointermove", at));
  check("a tip names the point", !plots[1].tip.hidden && plots[1].tip.textContent.includes("frame: 5"));
  plots[1].svg.dispatchEvent(new MouseEvent("click", at));
  check("a click on a plot seeks", outputs().every((text) => text === "frame 5"));
}

addEventListener("load", async () => {
  try {
    await wait(300);
    check("no other file is asked for", performance.getEntriesByType("resource").every((entry) => entry.name.startsWith("data:")));
    check("page is no wider than the window", document.documentElement.scrollWidth <= innerWidth);
    checkPlots();
    checkNames();
    checkTables();
    await checkPictures();
  } catch (error) {
    results.failed.push(`${error} ${error.stack}`);
  }
  for (const message of pageErrors) results.failed.push(`script error: ${message}`);
  const out = document.body.appendChild(document.createElement("pre"));
  out.id = "results";
  out.textContent = JSON.stringify(results);
});
