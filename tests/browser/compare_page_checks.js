// Checks of the page of an invented comparison: make_pages compare.
const firstSources = () => all("img", all(".tiles")[0]).map((image) => image.src);

function checkPlots() {
  check("three plots a scene", plots.length === 6);
  for (const plot of plots) {
    check(`${plot.title}: curves have length`, all("path.curve", plot.svg).every((curve) => curve.getTotalLength() > 50));
  }
  check("axes name their units", plots[0].svg.textContent.includes("ms a frame") && plots[0].svg.textContent.includes("relMSE"));
  check("points on the front have rings", all("circle.ring", plots[0].svg).length >= 4);
  const points = plots[1].places.filter((p) => p.name === data.names[1]);
  check("a value without a logarithm is left out", points.length === 2);
}

function checkNames() {
  const of = (name) => getComputedStyle(document.querySelector(`#legend [data-name="${name}"]`)).fill;
  for (const name of data.names) {
    const marks = all(`[data-name="${name}"]:not(path.curve)`);
    check(`${name}: one color everywhere`, marks.length > 10 && marks.every((mark) => getComputedStyle(mark).fill === of(name)));
    check(`${name}: curves have it too`, all(`path.curve[data-name="${name}"]`).every((curve) => getComputedStyle(curve).stroke === of(name)));
  }
  check("names differ in color", new Set(data.names.map(of)).size === data.names.length);
  check("the legend stands above all sections", byId("legend").compareDocumentPosition(byId("sections")) & Node.DOCUMENT_POSITION_FOLLOWING);
  const button = all("#legend button")[1];
  button.click();
  check("a name can be hidden", button.getAttribute("aria-pressed") === "false" && !plots[0].svg.querySelector(`[data-name="${data.names[1]}"]`));
  button.click();
  check("and shown again", Boolean(plots[0].svg.querySelector(`[data-name="${data.names[1]}"]`)));
  all("#legend button").forEach((one) => one.click());
  check("without names a plot says so", plots[0].svg.textContent === "nothing to show");
  all("#legend button").forEach((one) => one.click());
}

function checkFigures() {
  const tables = all("table");
  check("two tables a scene, and the setup", tables.length === 5);
  check("a row for each name", tables[0].tBodies[0].rows.length === data.names.length);
  const best = all("td.best", tables[0]);
  check("the best is bold", best.length === 8 && best.every((cell) => Number(getComputedStyle(cell).fontWeight) >= 600));
  check("titles are text", all("section .note")[0].textContent === "A <made-up> room");
  check("sections are linked", all("#contents a").every((link) => document.querySelector(link.getAttribute("href"))));
  check("the setup names the processor", tables[4].textContent.includes("processor"));
}

async function checkPictures() {
  check("a picture for each name and the reference", all("img", all(".tiles")[0]).length === data.names.length + 1);
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
}

async function checkPlaying() {
  const [play] = all(".controls .play");
  play.click();
  for (let i = 0; i < 40 && outputs()[0] === "frame 6"; i += 1) await wait(20);
  check("a gallery plays", outputs()[0] !== "frame 6" && play.ariaLabel === "Pause");
  press(" ");
  check("space pauses it", play.ariaLabel === "Play" && new Set(outputs()).size === 1);
}

function checkTips() {
  const place = plots[1].places.find((p) => p.x === 5);
  pointAt(plots[1], "pointermove", place.px, place.py);
  check("a tip names the frame and all curves", !plots[1].tip.hidden && ["frame 5", ...data.names.filter((name) => name !== data.names[1])].every((text) => plots[1].tip.textContent.includes(text)));
  pointAt(plots[1], "click", place.px, place.py);
  check("a click on a plot seeks", outputs().every((text) => text === "frame 5"));
  const point = plots[0].places[0];
  pointAt(plots[0], "pointermove", point.px + 3, point.py);
  check("a tip names the point", !plots[0].tip.hidden && plots[0].tip.textContent.includes(`${point.name}, ${point.label}`));
  pointAt(plots[0], "pointerleave", 0, 0);
  check("and goes with the pointer", plots[0].tip.hidden);
}

async function checkPage() {
  checkPlots();
  checkNames();
  checkFigures();
  await checkPictures();
  await checkPlaying();
  checkTips();
}
