const FILTERED = 6; // rows from which a table has a filter box
document.querySelectorAll("table:not(.still)").forEach((table) => {
  const heads = [...(table.tHead?.querySelectorAll("th") ?? [])];
  const body = table.tBodies[0];
  if (heads.length === 0 || body.rows.length < 2) return;
  const key = (row, column) => {
    const cell = row.cells[column];
    const text = cell.dataset.sort ?? cell.textContent.trim();
    const value = Number(text);
    return text === "" || text === "nan" || text === "–" ? null : Number.isNaN(value) ? text.toLowerCase() : value;
  };
  const compare = (x, y) => {
    if (typeof x === typeof y) return (x > y) - (x < y);
    return typeof x === "number" ? -1 : 1;
  };
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      const up = head.getAttribute("aria-sort") !== "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", up ? "ascending" : "descending");
      [...body.rows]
        .sort((a, b) => {
          const x = key(a, column), y = key(b, column);
          if (x === null || y === null) return (x === null) - (y === null);
          return up ? compare(x, y) : compare(y, x);
        })
        .forEach((row) => body.append(row));
    });
  });
  if (body.rows.length < FILTERED) return;
  const line = document.createElement("p"), label = document.createElement("label");
  const box = document.createElement("input"), count = document.createElement("output");
  line.className = "filter";
  box.type = "search";
  box.id = `${table.id || "rows"}-filter`;
  label.htmlFor = box.id;
  label.textContent = "Filter rows";
  line.append(label, " ", box, " ", count);
  box.addEventListener("input", () => {
    const words = box.value.toLowerCase().split(/\s+/).filter(Boolean);
    const rows = [...body.rows];
    rows.forEach((row) => {
      const text = row.textContent.toLowerCase();
      row.hidden = !words.every((word) => text.includes(word));
    });
    count.value = words.length ? `${rows.filter((row) => !row.hidden).length} of ${rows.length}` : "";
  });
  table.parentElement.before(line);
});
