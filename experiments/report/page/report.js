"use strict";
// Tables of the page become sortable by a press on a head, and long ones have a field that filters
// their rows. Text is only ever set as text.

const inOrder = new Intl.Collator("en", { numeric: true });

function made(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** What a cell is sorted by: its number if it has one, else its text; null for nothing there. */
function keyOf(cell) {
  if (cell.dataset.key !== undefined) return Number(cell.dataset.key);
  const text = cell.textContent.trim();
  return text === "-" || text === "" ? null : text;
}

function compared(one, other) {
  if (typeof one === "number" && typeof other === "number") return one - other;
  if (typeof one !== typeof other) return typeof one === "number" ? -1 : 1;
  return inOrder.compare(one, other);
}

/** Rows by a column; cells with nothing in them stay last either way. */
function sorted(rows, column, sign) {
  const keyed = rows.map((row, place) => ({ row, place, key: keyOf(row.cells[column]) }));
  keyed.sort((one, other) => {
    if (one.key === null || other.key === null) {
      return (one.key === null) - (other.key === null) || one.place - other.place;
    }
    return sign * compared(one.key, other.key) || one.place - other.place;
  });
  return keyed.map(({ row }) => row);
}

const NEXT = { none: "ascending", ascending: "descending", descending: "none" };

function makeSortable(table, said) {
  const heads = [...table.tHead.rows[0].cells];
  const body = table.tBodies[0];
  const given = [...body.rows];
  heads.forEach((head, column) => {
    const name = head.textContent;
    const button = made("button", { type: "button" }, ...head.childNodes, made("span", { class: "arrow", "aria-hidden": "true" }));
    head.setAttribute("aria-sort", "none");
    head.append(button);
    button.addEventListener("click", () => {
      const order = NEXT[head.getAttribute("aria-sort")];
      for (const other of heads) other.setAttribute("aria-sort", "none");
      head.setAttribute("aria-sort", order);
      body.append(...(order === "none" ? given : sorted(given, column, order === "ascending" ? 1 : -1)));
      said.textContent = order === "none" ? "order of the run" : `sorted by ${name}, ${order}`;
    });
  });
}

/** A row stays if every word typed is somewhere in it. */
function makeFiltered(box, table, said) {
  const rows = [...table.tBodies[0].rows].map((row) => ({ row, text: row.textContent.toLowerCase() }));
  const field = made("input", { type: "search", autocomplete: "off", spellcheck: "false" });
  const count = made("output", {}, `${rows.length} rows`);
  field.addEventListener("input", () => {
    const words = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    let left = 0;
    for (const { row, text } of rows) {
      row.hidden = !words.every((word) => text.includes(word));
      left += !row.hidden;
    }
    count.textContent = words.length ? `${left} of ${rows.length} rows` : `${rows.length} rows`;
    said.textContent = count.textContent;
  });
  const label = made("label", {}, "Only rows with ", field);
  box.insertBefore(made("p", { class: "filter" }, label, " ", count), box.querySelector(".scroll"));
}

for (const box of document.querySelectorAll(".table")) {
  const table = box.querySelector("table");
  const said = made("p", { class: "unseen", role: "status" });
  box.append(said);
  makeSortable(table, said);
  if (box.dataset.filter !== undefined) makeFiltered(box, table, said);
}
