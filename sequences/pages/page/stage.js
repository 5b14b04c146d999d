// A stage shows two pictures in one place: the first left, the second right of a divider.

function addStage(card, gallery) {
  const element = add(card, "div", undefined, "stage");
  const canvas = add(element, "canvas");
  [canvas.width, canvas.height] = [gallery.width, gallery.height];
  canvas.setAttribute("role", "img");
  const stage = { element, canvas, images: new Map(), index: 0, kind: 0, split: 0 };
  const sides = gallery.tiles.length > 1 ? ["left", "right"] : ["right"];
  sides.forEach((side, i) => add(element, "span", gallery.tiles[i].name, `tag ${side}`));
  if (sides.length > 1) addDivider(gallery, stage);
  gallery.stage = stage;
}

// Pictures are decoded when they are first asked for, and kept.
function stageImage(gallery, tile, kind, index) {
  const { stage } = gallery;
  const key = `${tile}/${kind}/${index}`;
  if (!stage.images.has(key)) {
    const loaded = new Image();
    loaded.addEventListener("load", () => drawStage(gallery));
    loaded.src = gallery.tiles[tile].pictures[kind][index];
    stage.images.set(key, loaded);
  }
  return stage.images.get(key);
}

function drawStage(gallery) {
  const { canvas, kind, index, split } = gallery.stage;
  const context = canvas.getContext("2d");
  const right = gallery.tiles.length - 1;
  const whole = stageImage(gallery, right, kind, index);
  if (whole.complete) context.drawImage(whole, 0, 0);
  const cut = Math.round(split * canvas.width);
  if (right === 0 || cut === 0) return;
  const left = stageImage(gallery, 0, kind, index);
  if (left.complete) context.drawImage(left, 0, 0, cut, canvas.height, 0, 0, cut, canvas.height);
}

function showOnStage(gallery, kind, index) {
  Object.assign(gallery.stage, { kind, index });
  gallery.stage.canvas.setAttribute("aria-label", `Frame ${gallery.frames[index]}, ${gallery.kinds[kind].name}`);
  drawStage(gallery);
  // The next frame is decoded while a viewer looks at this one.
  const next = (index + 1) % gallery.frames.length;
  gallery.tiles.forEach((_, tile) => stageImage(gallery, tile, kind, next));
}

function addDivider(gallery, stage) {
  const divider = add(stage.element, "div", undefined, "divider");
  add(divider, "i");
  const [left, right] = gallery.tiles.map((tile) => tile.name);
  const fixed = { role: "slider", tabindex: 0, "aria-label": `Divider between ${left} and ${right}`, "aria-valuemin": 0, "aria-valuemax": 100 };
  for (const [key, value] of Object.entries(fixed)) divider.setAttribute(key, value);
  const move = (split) => {
    stage.split = Math.max(0, Math.min(1, split));
    const percent = Math.round(stage.split * 100);
    divider.style.left = `${percent}%`;
    divider.setAttribute("aria-valuenow", percent);
    divider.setAttribute("aria-valuetext", `${percent} % ${left}`);
    if (gallery.stage) drawStage(gallery);
  };
  divider.addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1 };
    if (!(event.key in moves)) return;
    move(stage.split + moves[event.key]);
    event.preventDefault();
  });
  followPointer(stage.element, divider, move);
  move(0.5);
}

function followPointer(element, divider, move) {
  const follow = (event) => {
    const area = element.getBoundingClientRect();
    move((event.clientX - area.left) / area.width);
  };
  element.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    element.setPointerCapture(event.pointerId);
    divider.focus({ preventScroll: true });
    event.preventDefault();
    follow(event);
  });
  element.addEventListener("pointermove", (event) => {
    if (element.hasPointerCapture(event.pointerId)) follow(event);
  });
}
