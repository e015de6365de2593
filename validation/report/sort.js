document.querySelectorAll("table.sortable").forEach((table) => {
  table.querySelectorAll("thead th").forEach((head, column) => {
    head.addEventListener("click", () => {
      const body = table.tBodies[0];
      const up = head.dataset.up !== "1";
      head.dataset.up = up ? "1" : "0";
      const key = (row) => {
        const cell = row.cells[Math.min(column, row.cells.length - 1)];
        const text = cell.dataset.sort ?? cell.textContent;
        const value = parseFloat(text);
        return Number.isNaN(value) ? text : value;
      };
      [...body.rows]
        .sort((a, b) => {
          const x = key(a), y = key(b);
          const order = typeof x === typeof y ? (x > y) - (x < y) : typeof x === "number" ? -1 : 1;
          return up ? order : -order;
        })
        .forEach((row) => body.append(row));
    });
  });
});
