// Builds the page from its data, and starts it.

function addSection(section, index) {
  const element = add(byId("sections"), "section");
  if (section.title) {
    add(element, "h2", section.title).id = `section-${index}`;
    add(byId("contents"), "a", section.title).href = `#section-${index}`;
  }
  if (section.note) add(element, "p", section.note, "note");
  if (section.plots.length) {
    const grid = add(element, "div", undefined, section.plots.length % 2 ? "plots odd" : "plots");
    section.plots.forEach((plot) => addPlot(grid, plot));
  }
  if (section.tables.length) {
    const tables = add(element, "div", undefined, "tables");
    section.tables.forEach((table) => addTable(tables, table));
  }
  section.galleries.filter((gallery) => gallery.frames.length).forEach((gallery) => addGallery(element, gallery));
}

// The gallery that plays, else the first one in the window.
function galleryInView() {
  const isInWindow = ({ card }) => card.getBoundingClientRect().bottom > 0 && card.getBoundingClientRect().top < innerHeight;
  return galleries.find((gallery) => gallery.isPlaying) || galleries.find(isInWindow) || galleries[0];
}

function onKey(event) {
  if (!galleries.length || event.altKey || event.ctrlKey || event.metaKey) return;
  const gallery = galleryInView();
  const isIn = (selector) => Boolean(event.target.closest && event.target.closest(selector));
  const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (step && !isIn("input, [role=slider], .scroll")) {
    const { frames } = gallery;
    seek(frames[Math.max(0, Math.min(frames.length - 1, indexIn(gallery) + step))]);
  } else if (event.key === " " && !isIn("a, button, input[type=checkbox], input[type=radio]")) {
    setPlaying(gallery, !gallery.isPlaying);
  } else {
    return;
  }
  event.preventDefault();
}

byId("subtitle").textContent = data.subtitle;
data.sections.forEach(addSection);
byId("contents").hidden = byId("contents").children.length < 3;
addLegend();
paintAll();
if (galleries.length) seek(galleries[0].frames[0]);
galleries.forEach(showPlaying);
addEventListener("resize", () => requestAnimationFrame(paintAll));
document.addEventListener("keydown", onKey);
