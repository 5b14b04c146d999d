// Galleries: pictures of one frame and one kind at a time, with controls to choose and to play.

const galleries = [];

// ---- controls

const icons = { play: "M4 2l10 6-10 6z", pause: "M3 2h4v12H3zM9 2h4v12H9z" };

function addPlayButton(controls, gallery) {
  gallery.play = add(controls, "button", undefined, "play");
  gallery.play.type = "button";
  const icon = gallery.play.appendChild(svg("svg", { viewBox: "0 0 16 16", "aria-hidden": "true" }));
  icon.append(svg("path", {}));
  gallery.play.addEventListener("click", () => setPlaying(gallery, !gallery.isPlaying));
}

function addSlider(controls, gallery) {
  gallery.slider = add(controls, "input");
  Object.assign(gallery.slider, { type: "range", min: 0, max: gallery.frames.length - 1, step: 1, value: 0 });
  gallery.slider.setAttribute("aria-label", "Frame");
  gallery.slider.addEventListener("input", () => seek(gallery.frames[Number(gallery.slider.value)]));
  gallery.output = add(controls, "output");
  gallery.slider.disabled = gallery.play.disabled = gallery.frames.length < 2;
}

function addKinds(controls, gallery) {
  const fields = add(controls, "fieldset");
  fields.hidden = gallery.kinds.length < 2;
  add(fields, "legend", "Show");
  gallery.radios = gallery.kinds.map((kind, i) => {
    const label = add(fields, "label");
    const radio = add(label, "input");
    radio.type = "radio";
    radio.name = `kind-${galleries.length}`;
    radio.addEventListener("change", () => {
      view.kind = i;
      galleries.forEach(showGallery);
    });
    label.append(` ${kind.name}`);
    return radio;
  });
}

function addControls(card, gallery) {
  const controls = add(card, "div", undefined, "controls");
  addPlayButton(controls, gallery);
  addSlider(controls, gallery);
  addKinds(controls, gallery);
  gallery.kindNote = add(card, "p", undefined, "note");
  gallery.ramp = add(card, "div", undefined, "ramp");
}

// ---- pictures

function addTiles(card, gallery) {
  const tiles = add(card, "div", undefined, "tiles");
  gallery.images = gallery.tiles.map((tile) => {
    const figure = add(tiles, "figure");
    const image = add(figure, "img");
    image.decoding = "sync";
    addName(add(figure, "figcaption"), tile.name);
    return image;
  });
}

function addGallery(parent, given) {
  const gallery = { ...given, isPlaying: false, timer: 0 };
  const card = addCard(parent, gallery.title);
  if (gallery.split) addStage(card, gallery);
  addControls(card, gallery);
  if (!gallery.split) addTiles(card, gallery);
  if (gallery.note) add(card, "p", gallery.note, "note");
  gallery.card = card;
  galleries.push(gallery);
}

// The place of the frame in view, or of the nearest one that the gallery has.
function indexIn(gallery) {
  const distances = gallery.frames.map((frame) => Math.abs(frame - view.frame));
  return distances.indexOf(Math.min(...distances));
}

function showRamp(gallery, { ramp, low, high }) {
  gallery.ramp.hidden = ramp.length === 0;
  gallery.ramp.replaceChildren();
  if (!ramp.length) return;
  gallery.ramp.append(low);
  add(gallery.ramp, "i").style.background = `linear-gradient(90deg, ${ramp.join(", ")})`;
  gallery.ramp.append(high);
}

function showGallery(gallery) {
  const index = indexIn(gallery);
  const kind = Math.min(view.kind, gallery.kinds.length - 1);
  const frame = `frame ${gallery.frames[index]}`;
  gallery.radios.forEach((radio, i) => { radio.checked = i === kind; });
  gallery.slider.value = index;
  gallery.slider.setAttribute("aria-valuetext", frame);
  gallery.output.textContent = frame;
  gallery.kindNote.textContent = gallery.kinds[kind].note;
  gallery.kindNote.hidden = !gallery.kinds[kind].note;
  showRamp(gallery, gallery.kinds[kind]);
  if (gallery.split) {
    showOnStage(gallery, kind, index);
    return;
  }
  gallery.images.forEach((image, i) => {
    image.src = gallery.tiles[i].pictures[kind][index];
    image.alt = `${gallery.tiles[i].name}, ${gallery.kinds[kind].name}, ${frame}`;
  });
}

// ---- moving through the frames

// While one gallery plays, the others wait.
function showFrame(frame, shown = galleries) {
  view.frame = frame;
  shown.forEach(showGallery);
  plots.forEach(markFrame);
}

function seek(frame) {
  galleries.filter((gallery) => gallery.isPlaying).forEach(stop);
  showFrame(frame);
}

function showPlaying(gallery) {
  gallery.play.setAttribute("aria-label", gallery.isPlaying ? "Pause" : "Play");
  gallery.play.querySelector("path").setAttribute("d", gallery.isPlaying ? icons.pause : icons.play);
}

function stop(gallery) {
  clearInterval(gallery.timer);
  gallery.isPlaying = false;
  showPlaying(gallery);
}

function setPlaying(gallery, playing) {
  seek(view.frame);
  if (!playing || gallery.frames.length < 2) return;
  gallery.isPlaying = true;
  showPlaying(gallery);
  // The clock tells which frame is due: a slow browser leaves out frames and keeps the pace.
  const first = indexIn(gallery), start = performance.now();
  gallery.timer = setInterval(() => {
    const passed = Math.floor(((performance.now() - start) / 1000) * gallery.fps);
    const due = gallery.frames[(first + passed) % gallery.frames.length];
    if (due !== view.frame) showFrame(due, [gallery]);
  }, 500 / gallery.fps);
}
