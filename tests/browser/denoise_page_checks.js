// Checks of the page of `denoise` over a shot made for it: make_pages denoise.
const [timePlot, newPlot] = plots;
const [player] = galleries;
const canvas = document.querySelector(".stage canvas");
const divider = document.querySelector(".divider");
const pixels = () => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
const differs = (a, b) => a.some((value, i) => value !== b[i]);

function checkPlayer() {
  check("title names the first and the last file", document.querySelector("h1").textContent === "s.0001.exr to s.0005.exr, denoised");
  check("both sides are named", all(".tag").map((tag) => tag.textContent).join() === "noisy,denoised (eigenlight)");
  check("canvas has the size of the frames", canvas.width === 96 && canvas.height === 64);
  check("the picture is drawn", pixels().some((value, i) => i % 4 < 3 && value > 50));
  const names = all("fieldset label").map((label) => label.textContent.trim());
  check("the beauty and each layer of light", names.join() === "View.Combined,View.DiffInd");
}

// Noise differs from pixel to pixel; the painted wall hardly does.
const roughness = (data) => {
  let sum = 0;
  for (let i = 4 * 40 * canvas.width; i < 4 * 50 * canvas.width; i += 4) sum += Math.abs(data[i] - data[i + 4]);
  return sum;
};

async function checkDivider() {
  all("fieldset input")[1].click();  // light without paint
  await wait(300);
  press("Home", divider);
  await wait(50);
  const clean = pixels();
  press("End", divider);
  await wait(50);
  check("the noisy side is rougher by far", roughness(pixels()) > 3 * roughness(clean));
  all("fieldset input")[0].click();
  await wait(300);
  check("the beauty is another picture", differs(clean, pixels()));
}

async function checkFrames() {
  const first = pixels();
  press("ArrowRight");
  await wait(300);
  check("right arrow steps", outputs()[0] === "frame 2" && differs(first, pixels()));
  check("plots mark the frame", plots.every((plot) => plot.now.getAttribute("x1") === String(plot.toX(2))));
  pointAt(timePlot, "click", timePlot.toX(5), 50);
  check("a click on a plot seeks", outputs()[0] === "frame 5");
}

function checkFacts() {
  const text = document.body.textContent;
  check("files, frames and size", ["s.0001.exr", "5 (1-5)", "96 × 64 pixels at (0, 0)"].every((part) => text.includes(part)));
  const rows = all("table tr").map((row) => [...row.cells].map((cell) => cell.textContent));
  const row = (name) => rows.find((cells) => cells[0] === name) ?? [];
  check("what each layer is", row("View.DiffInd").includes("denoised") && row("View.Combined").includes("composed") && row("matte").includes("copied"));
  check("what was found", row("View.Combined").length > 0 && text.includes("motion") && text.includes("Found on the first frames"));
  check("warnings stand first", text.includes("Warnings") && text.indexOf("Warnings") < text.indexOf("Summary", text.indexOf("Warnings")));
  check("pixels with NaN are counted", row("excluded as NaN or Inf").join().includes("15 pixels"));
  check("all stages have a time", ["read", "filter", "compose", "write"].every((name) => Number(row(name)[1]) > 0) && row("all").length === 2);
}

function checkPlots() {
  check("bars of reading and writing have area", ["read", "write"].every((name) => timePlot.svg.querySelector(`path[data-name=${name}]`).getBBox().height > 2));
  check("new pixels are a share", newPlot.series[0].y.slice(1).every((value) => value > 0 && value < 20));
}

async function checkPage() {
  checkPlayer();
  checkFacts();
  checkPlots();
  await checkFrames();
  await checkDivider();
}
