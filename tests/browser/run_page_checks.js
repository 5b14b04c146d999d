// Checks of the page of an invented run: make_pages run-N.
const [timePlot, newPlot, rankPlot] = plots;
const [player] = galleries;
const frameCount = timePlot.frames.length;
const canvas = document.querySelector(".stage canvas");
const divider = document.querySelector(".divider");
const pixels = () => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
const differs = (a, b) => a.some((value, i) => value !== b[i]);
const shownFrame = () => outputs()[0];
const isVisible = (name) => Boolean(timePlot.svg.querySelector(`path[data-name="${name}"]`));

function checkStart() {
  check("title is text", document.querySelector("h1").textContent.startsWith('A <made-up> room & its "light"'));
  check("canvas has the size of the frames", canvas.width > 100 && canvas.height > 50);
  check("first frame is drawn", pixels().some((value, i) => i % 4 < 3 && value > 50));
  check("slider covers all shown frames", Number(player.slider.max) === player.frames.length - 1 && player.frames.length <= frameCount);
  check("both sides are named", all(".tag").map((tag) => tag.textContent).join() === "noisy,denoised (running-mean)");
}

function checkPlots() {
  const stages = timePlot.series.map((series) => series.name);
  check("a bar path for each stage", stages.length === data.names.length && all("path.bars", timePlot.svg).length === stages.length);
  check("bars have area", timePlot.svg.querySelector("path[data-name=source]").getBBox().height > 20);
  check("colors of stages differ", new Set(stages.map((name) => getComputedStyle(timePlot.svg.querySelector(`path[data-name="${name}"]`)).fill)).size === stages.length);
  for (const plot of [newPlot, rankPlot]) {
    const box = plot.svg.querySelector("path.curve").getBBox();
    check(`${plot.title}: a curve or a dot`, frameCount > 1 ? box.width > 100 : all("circle", plot.svg).length === 1);
  }
  check("a cut does not set the scale", frameCount === 1 || newPlot.ys.share(10) > 0.5);
  pointAt(timePlot, "pointermove", timePlot.toX(0), 50);
  const tip = timePlot.tip.textContent;
  check("a tip names all stages and their sum", stages.concat("all", "frame 0").every((text) => tip.includes(text)) && !/NaN|undefined/.test(tip));
  const sum = timePlot.series.reduce((all, series) => all + series.y[0], 0);
  check("the sum is that of the stages", tip.endsWith(`all ${number(sum)}`));
  const heights = all("path.bars", timePlot.svg).map((path) => path.getBBox());
  check("each bar stands on the one before", heights.every((bars, i) => !i || bars.y < heights[i - 1].y));
  pointAt(timePlot, "pointerleave", 0, 0);
}

function checkLegend() {
  check("the legend stands beside the only plot with stages", byId("legend").parentElement === timePlot.host.parentElement);
  const [first] = data.names.filter((name) => !data.background.names.includes(name));
  const button = all("#legend button").find((one) => one.textContent === first);
  button.click();
  check("a stage can be left out", !isVisible(first) && isVisible("source"));
  button.click();
  const box = document.querySelector("#legend input");
  box.click();
  check("rendering and files can be left out", data.background.names.every((name) => !isVisible(name)) && isVisible(first));
  box.click();
  check("and come back", data.names.every(isVisible) && box.checked);
}

function checkRun() {
  const [run, times, skips] = all("table");
  check("the run is described", run.rows.length >= 12 && run.textContent.includes("320 × 180 pixels"));
  check("times of all stages and their sum", times.rows.length === data.names.length + 2 && times.rows[times.rows.length - 1].className === "total");
  check("all skip counters are shown", skips.tBodies[0].rows.length === 6);
}

async function checkDivider() {
  player.slider.focus();
  const half = pixels();
  const { element } = player.stage;
  const area = element.getBoundingClientRect();
  element.setPointerCapture = () => {};
  element.dispatchEvent(new PointerEvent("pointerdown", {
    pointerId: 1, button: 0, bubbles: true, cancelable: true, clientX: area.left + 0.2 * area.width, clientY: area.top + 20 }));
  await wait(50);
  const line = divider.getBoundingClientRect();
  check("divider follows the pointer", divider.ariaValueNow === "20" && Math.abs(line.x + line.width / 2 - area.x - 0.2 * area.width) < 3);
  check("divider moves the border of the pictures", differs(half, pixels()));
  const before = shownFrame();
  press("ArrowRight", divider);
  check("arrows on the divider move it", divider.ariaValueNow === "22");
  check("and leave the frame", shownFrame() === before);
  press("Home", divider);
  check("divider reaches the edge", divider.ariaValueNow === "0");
  press("End", divider);
  await wait(50);
  check("all noisy differs from half noisy", differs(half, pixels()));
}

async function checkKinds() {
  const full = pixels();
  all("fieldset input")[1].click();
  await wait(300);
  check("indirect light is another picture", differs(full, pixels()));
  check("its label says so", canvas.ariaLabel.includes("indirect"));
}

async function checkFrames() {
  if (frameCount === 1) {
    check("one frame cannot be played", player.play.disabled && player.slider.disabled);
    press("ArrowRight");
    check("one frame stays", shownFrame() === "frame 0");
    return;
  }
  const first = pixels();
  press("ArrowRight");
  await wait(300);
  check("right arrow steps", shownFrame() === `frame ${player.frames[1]}`);
  check("the picture follows", differs(first, pixels()));
  check("plots mark the frame", plots.every((plot) => plot.now.getAttribute("x1") === String(plot.toX(player.frames[1]))));
  press("ArrowLeft");
  check("left arrow steps back", shownFrame() === "frame 0");
  const last = `frame ${player.frames.at(-1)}`;
  player.slider.value = player.frames.length - 1;
  player.slider.dispatchEvent(new Event("input", { bubbles: true }));
  check("slider seeks", shownFrame() === last);
  press(" ");
  check("space plays", player.play.ariaLabel === "Pause");
  for (let i = 0; i < 40 && shownFrame() === last; i += 1) await wait(50);
  check("playing moves on", shownFrame() !== last);
  press(" ");
  check("space pauses", player.play.ariaLabel === "Play");
  for (const frame of [player.frames[2], 0]) {
    pointAt(timePlot, "click", timePlot.toX(frame), 50);
    check("a click on a plot seeks", shownFrame() === `frame ${frame}`);
  }
}

async function checkPage() {
  checkStart();
  checkPlots();
  checkLegend();
  checkRun();
  await checkFrames();
  await checkDivider();
  await checkKinds();
}
