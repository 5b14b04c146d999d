// Tables: numbers are rounded here, the best of a column is bold.

const isText = (value) => typeof value === "string";

function addHead(element, table) {
  if (!table.names && !table.columns.some(Boolean)) return;
  const head = element.createTHead().insertRow();
  add(head, "th", table.names).scope = "col";
  table.columns.forEach((title, i) => {
    const holdsText = table.rows.some((row) => isText(row.cells[i]));
    add(head, "th", title, holdsText ? "words" : "").scope = "col";
  });
}

function addRow(body, row) {
  const line = body.insertRow();
  if (row.total) line.className = "total";
  const name = add(line, "th");
  name.scope = "row";
  addName(name, row.name);
  row.cells.forEach((value, i) => {
    if (isText(value)) add(line, "td", value, "words");
    else add(line, "td", number(value), row.best[i] ? "best" : "");
  });
}

function addTable(parent, table) {
  const card = addCard(parent, table.title);
  if (table.columns.length > 3) card.classList.add("wide");
  const element = add(add(card, "div", undefined, "scroll"), "table");
  addHead(element, table);
  const body = element.createTBody();
  table.rows.forEach((row) => addRow(body, row));
  if (table.note) add(card, "p", table.note, "note");
}
