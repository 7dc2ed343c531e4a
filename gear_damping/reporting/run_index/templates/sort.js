"use strict";
// Each heading becomes a button; a click, Enter or Space sorts by its column, and again the other way round.
for (const table of document.querySelectorAll("table[data-sortable]")) {
  const headings = Array.from(table.tHead.rows[0].cells);
  const said = document.querySelector(".sorted");
  const key = (row, column) => row.cells[column].dataset.key ?? row.cells[column].textContent.trim();
  const compare = (one, other) => {
    const both = [Number(one), Number(other)];
    return one !== "" && other !== "" && both.every(Number.isFinite)
      ? both[0] - both[1]
      : one.localeCompare(other, "en", { numeric: true });
  };
  const sort = (heading) => {
    const column = headings.indexOf(heading);
    const up = heading.getAttribute("aria-sort") !== "ascending";
    const rows = Array.from(table.tBodies[0].rows);
    rows.sort((one, other) => (up ? 1 : -1) * compare(key(one, column), key(other, column)));
    table.tBodies[0].append(...rows);
    headings.forEach((one) => one.removeAttribute("aria-sort"));
    heading.setAttribute("aria-sort", up ? "ascending" : "descending");
    say(heading);
  };
  const say = (heading) => {
    said.textContent = `Sorted by ${heading.textContent.trim()}, ${heading.getAttribute("aria-sort")}.`;
  };
  for (const heading of headings.filter((one) => !("unsorted" in one.dataset))) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = heading.textContent;
    button.addEventListener("click", () => sort(heading));
    heading.replaceChildren(button);
  }
  say(table.tHead.querySelector("[aria-sort]"));
}
