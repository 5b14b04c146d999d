// Appended to a copy of the report page by report_page_test.py; expectedFrames is set before.
const results = { passed: 0, failed: [] };

function check(what, condition) {
  if (condition) results.passed += 1;
  else results.failed.push(what);
}

const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const pixels = () => {
  const canvas = byId("picture");
  return canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
};
const differs = (a, b) => a.some((value, i) => value !== b[i]);
const press = (key, target = document.body) => target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
const shownFrame = () => byId("frame-number").textContent;

function checkStart() {
  check("title is text", document.querySelector("h1").textContent.startsWith('A <made-up> room & its "light"'));
  check("canvas has the size of the frames", byId("picture").width > 100 && byId("picture").height > 50);
  check("first frame is drawn", pixels().some((value, i) => i % 4 < 3 && value > 50));
  check("slider covers all shown frames", Number(byId("slider").max) === Math.min(expectedFrames, pictures.frames.length) - 1);
  check("no other file is asked for", performance.getEntriesByType("resource").every((entry) => entry.name.startsWith("data:")));
  check("page is no wider than the window", document.documentElement.scrollWidth <= innerWidth);
}

function checkPlots() {
  check("a bar path per stage", document.querySelectorAll("#plot-time path[data-stage]").length === 8);
  check("bars have area", byId("plot-time").querySelector("path[data-stage=source]").getBBox().height > 20);
  check("legend names the stages", byId("legend").textContent.includes("warp"));
  for (const id of ["plot-new", "plot-rank"]) {
    const box = byId(id).querySelector("path.curve").getBBox();
    check(`${id} has a curve or a dot`, expectedFrames > 1 ? box.width > 100 : byId(id).querySelectorAll("circle").length === 1);
  }
  const texts = [...document.querySelectorAll(".plot text")].map((text) => text.textContent);
  check("axes have numbers", texts.length > 10 && texts.every((text) => !/NaN|undefined|Infinity/.test(text)));
  byId("with-rendering").click();
  check("rendering can be left out", !byId("plot-time").querySelector("path[data-stage=source]"));
  byId("with-rendering").click();
  check("tables are filled", byId("summary").rows.length >= 8 && byId("times").rows.length === 10 && byId("skips").rows.length === 5);
  check("tables hold numbers", [...document.querySelectorAll("#times td, #skips td")].every((cell) => /^[\d.,e–-]+( %)?$/.test(cell.textContent)));
}

async function checkDivider() {
  byId("slider").focus();
  const half = pixels();
  const box = byId("stage").getBoundingClientRect();
  const at = (type, share) => byId("stage").dispatchEvent(new PointerEvent(type, {
    pointerId: 1, button: 0, bubbles: true, cancelable: true, clientX: box.left + share * box.width, clientY: box.top + 20 }));
  byId("stage").setPointerCapture = () => {};
  at("pointerdown", 0.2);
  await wait(50);
  check("divider follows the pointer", byId("divider").getAttribute("aria-valuenow") === "20");
  check("divider moves the border of the pictures", differs(half, pixels()));
  const before = shownFrame();
  press("ArrowRight", byId("divider"));
  check("arrows on the divider move it", byId("divider").getAttribute("aria-valuenow") === "22");
  check("and leave the frame", shownFrame() === before);
  press("Home", byId("divider"));
  check("divider reaches the edge", byId("divider").getAttribute("aria-valuenow") === "0");
  press("End", byId("divider"));
  await wait(50);
  check("all noisy differs from half noisy", differs(half, pixels()));
}

async function checkKinds() {
  const beauty = pixels();
  document.querySelector("input[value=indirect]").click();
  await wait(300);
  check("indirect light is another picture", differs(beauty, pixels()));
  check("its label says so", byId("picture").getAttribute("aria-label").includes("indirect"));
}

async function checkFrames() {
  if (expectedFrames === 1) {
    check("one frame cannot be played", byId("play").disabled && byId("slider").disabled);
    press("ArrowRight");
    check("one frame stays", shownFrame() === "frame 0");
    return;
  }
  const first = pixels();
  press("ArrowRight");
  await wait(300);
  check("right arrow steps", shownFrame() === `frame ${pictures.frames[1]}`);
  check("the picture follows", differs(first, pixels()));
  press("ArrowLeft");
  check("left arrow steps back", shownFrame() === "frame 0");
  byId("slider").value = pictures.frames.length - 1;
  byId("slider").dispatchEvent(new Event("input", { bubbles: true }));
  check("slider seeks", shownFrame() === `frame ${pictures.frames.at(-1)}`);
  press(" ");
  check("space plays", byId("play").getAttribute("aria-label") === "Pause");
  for (let i = 0; i < 40 && shownFrame() === `frame ${pictures.frames.at(-1)}`; i += 1) await wait(50);
  check("playing moves on", shownFrame() !== `frame ${pictures.frames.at(-1)}`);
  press(" ");
  check("space pauses", byId("play").getAttribute("aria-label") === "Play");
  const plot = byId("plot-time").querySelector("svg").getBoundingClientRect();
  byId("plot-time").querySelector("svg").dispatchEvent(new MouseEvent("click", { clientX: plot.left + 54, bubbles: true }));
  check("a click on a plot seeks", shownFrame() === "frame 0");
}

addEventListener("load", async () => {
  try {
    await wait(500);
    checkStart();
    checkPlots();
    await checkFrames();
    await checkDivider();
    await checkKinds();
  } catch (error) {
    results.failed.push(`${error}`);
  }
  for (const message of pageErrors) results.failed.push(`script error: ${message}`);
  const out = document.body.appendChild(document.createElement("pre"));
  out.id = "results";
  out.textContent = JSON.stringify(results);
});
