"use strict";
// Tables that sort when a heading is pressed; numbers stand to the right.
carom.tables = (() => {
  const cellsOf = (table, column) => [...table.tBodies[0].rows].map((row) => row.cells[column]);
  const isEmpty = (text) => ["", "-"].includes(text.trim());
  const isNumeric = (cells) =>
    cells.some((cell) => !isEmpty(cell.textContent)) &&
    cells.every((cell) => isEmpty(cell.textContent) || carom.numbers.leading(cell.textContent) !== null);

  const sort = (table, column, numeric, descending) => {
    const key = (row) => {
      const text = row.cells[column].textContent.trim();
      return numeric ? (isEmpty(text) ? -Infinity : carom.numbers.leading(text)) : text;
    };
    const compare = (a, b) => (numeric ? a.key - b.key : a.key.localeCompare(b.key));
    const rows = [...table.tBodies[0].rows].map((row) => ({ row, key: key(row) }));
    rows.sort((a, b) => (descending ? compare(b, a) : compare(a, b)));
    table.tBodies[0].append(...rows.map((entry) => entry.row));
  };

  const makeSortable = (table, heading, column, numeric) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = heading.textContent;
    heading.replaceChildren(button);
    button.addEventListener("click", () => {
      const descending = heading.getAttribute("aria-sort") === "ascending";
      for (const other of heading.parentElement.cells) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
      sort(table, column, numeric, descending);
    });
  };

  const longText = 40; // characters from which a cell wraps
  for (const table of document.querySelectorAll("table")) {
    [...table.tHead.rows[0].cells].forEach((heading, column) => {
      const cells = cellsOf(table, column);
      const numeric = isNumeric(cells);
      if (numeric) for (const cell of [heading, ...cells]) cell.classList.add("number");
      for (const cell of cells) if (cell.textContent.length > longText) cell.classList.add("words");
      if (table.classList.contains("sortable")) makeSortable(table, heading, column, numeric);
    });
  }
  return { sort };
})();
