// Checks of the page of an invented paper: make_pages paper.
async function checkPage() {
  const tables = all("table");
  check("claims, one table, and the setup", tables.length === 3);
  const claims = all("td", tables[0]).map((cell) => cell.textContent);
  check("claims stand beside our figures", ["the filter is fast", "1 ms", "2 ms", "held in part", "held"].every((text) => claims.includes(text)));
  check("text is left aligned", all("td.words").every((cell) => getComputedStyle(cell).textAlign === "left"));
  check("large numbers are short", tables[1].textContent.includes("1.23e+7"));
  check("two plots", plots.length === 2);
  check("curves have length", all("path.curve").every((curve) => curve.getTotalLength() > 50));
  check("the legend names all series", byId("legend").textContent === "ourstheirs");
  press("ArrowRight");
  press(" ");
  check("keys do nothing without pictures", view.frame === null && galleries.length === 0);
  check("there are no controls", all(".controls").length === 0);
  check("the setup names both machines", ["hardware of the paper", "processor here"].every((text) => tables[2].textContent.includes(text)));
}
