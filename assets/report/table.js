// The shown run's frames as a table, sorted by any column. Only rows in sight are in the page: there may be thousands.

const framesTable = (() => {
  const box = element("frames"), rowHeight = 26;  // px, as in live.css
  const table = document.createElement("table"), head = table.createTHead(), body = table.createTBody();
  box.append(table);
  let run = null, order = [], columns = [], allFigures = false, sort = {column: 0, down: false};

  function columnsOf() {
    const fixed = [
      {title: "Frame", number: true, value: (row) => run.frames[row], text: (row) => String(run.frames[row])},
      {title: "Time, s", number: true, value: (row) => run.seconds[row], text: (row) => run.seconds[row].toFixed(2)},
      {title: "Status", value: (row) => run.status[row], text: (row) => run.status[row]},
    ];
    const figures = data.figures
        .filter((figure) => (allFigures || figure.usual) && run.figures[figure.name].some((value) => value !== null))
        .map((figure) => ({
          title: withUnit(figure), help: figure.help, number: true, worse: figure.worse,
          value: (row) => run.figures[figure.name][row], text: (row) => shownValue(figure, run.figures[figure.name][row]),
        }));
    const note = {title: "Note", value: (row) => run.note[row] || null, text: (row) => run.note[row] || "–"};
    return [...fixed, ...figures, ...(run.note.some(Boolean) ? [note] : [])];
  }

  /// Rows without a value come last, whichever way.
  function sortRows() {
    const {value} = columns[sort.column], sign = sort.down ? -1 : 1;
    order = run.frames.map((_, row) => row).sort((a, b) => {
      const x = value(a), y = value(b);
      if (x === null || y === null) return (x === null) - (y === null) || a - b;
      return sign * (x < y ? -1 : x > y ? 1 : 0) || a - b;
    });
  }

  function drawHead() {
    const row = document.createElement("tr");
    columns.forEach((column, i) => {
      const cell = document.createElement("th");
      cell.scope = "col";
      cell.title = column.help ?? "";
      const sorted = i === sort.column;
      cell.setAttribute("aria-sort", sorted ? (sort.down ? "descending" : "ascending") : "none");
      addButton(cell, column.title + (sorted ? (sort.down ? " ↓" : " ↑") : ""), "Sort by this", () => {
        // The worst first; the other way at the second time.
        sort = {column: i, down: i === sort.column ? !sort.down : column.worse === "high"};
        drawHead();
        sortRows();
        box.scrollTop = 0;
        drawRows();
        head.rows[0].cells[i].firstChild.focus({preventScroll: true});
      });
      row.append(cell);
    });
    head.replaceChildren(row);
  }

  function spacer(rows) {
    const row = document.createElement("tr"), cell = row.insertCell();
    row.setAttribute("aria-hidden", "true");
    cell.colSpan = columns.length;
    cell.className = "spacer";
    cell.style.height = `${rows * rowHeight}px`;
    return row;
  }

  function drawRows() {
    const first = Math.max(0, Math.floor(box.scrollTop / rowHeight) - 5);
    const last = Math.min(order.length, first + Math.ceil(box.clientHeight / rowHeight) + 12);
    const rows = first > 0 ? [spacer(first)] : [];
    for (const at of order.slice(first, last)) {
      const row = document.createElement("tr");
      row.dataset.frame = run.frames[at];
      if (run.frames[at] === cursor.frame) row.setAttribute("aria-current", "true");
      if (!run.positions[at]) row.className = "lost";
      columns.forEach((column, i) => {
        const cell = row.insertCell();
        if (column.number) cell.className = "number";
        if (i === 0) {
          const link = document.createElement("a");
          link.href = `#frame=${run.frames[at]}&run=${cursor.run + 1}&sequence=${cursor.sequence + 1}`;
          link.textContent = column.text(at);
          cell.append(link);
        } else {
          cell.textContent = column.text(at);
        }
      });
      rows.push(row);
    }
    if (last < order.length) rows.push(spacer(order.length - last));
    body.replaceChildren(...rows);
  }

  function fill() {
    const name = columns[sort.column]?.title;
    columns = columnsOf();
    sort.column = Math.max(0, columns.findIndex((column) => column.title === name));
    drawHead();
    sortRows();
  }

  /// The cursor's row into sight, unless it is.
  function reveal() {
    const at = order.indexOf(cursor.row), top = at * rowHeight;
    if (at < 0) return;
    const room = box.clientHeight - head.offsetHeight - rowHeight;
    if (top < box.scrollTop || top > box.scrollTop + room) box.scrollTop = Math.max(0, top - room / 2);
  }

  const soon = drawsSoon(drawRows);
  box.addEventListener("scroll", soon);
  body.addEventListener("click", (event) => {
    const row = event.target.closest("tr[data-frame]");
    if (!row) return;
    event.preventDefault();
    cursor.go({frame: Number(row.dataset.frame)});
  });
  addToggle(element("table-toggles"), "all figures", {type: "checkbox"}, (input) => {
    allFigures = input.checked;
    fill();
    drawRows();
  });

  cursor.followers.push(() => {
    if (run !== cursor.shownRun) {
      run = cursor.shownRun;
      fill();
    }
    reveal();
    drawRows();
  });
  return {box, soon};
})();

/// Tables that stand in the page as they are: a click on a head sorts by it, dashes last.
for (const table of document.querySelectorAll("div.scroll > table")) {
  const heads = [...table.tHead.rows[0].cells], body = table.tBodies[0];
  const valueOf = (row, i) => {
    const text = row.cells[i].textContent.trim(), number = parseFloat(text);
    return text === "–" || text === "" ? null : Number.isNaN(number) ? text : number;
  };
  heads.forEach((head, i) => {
    const words = head.textContent;
    head.textContent = "";
    addButton(head, words, "Sort by this", () => {
      const down = head.getAttribute("aria-sort") === "ascending", sign = down ? -1 : 1;
      for (const other of heads) other.setAttribute("aria-sort", "none");
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const rows = [...body.rows].map((row, place) => ({row, place, value: valueOf(row, i)}));
      rows.sort((a, b) => {
        if (a.value === null || b.value === null) return (a.value === null) - (b.value === null) || a.place - b.place;
        return sign * (a.value < b.value ? -1 : a.value > b.value ? 1 : 0) || a.place - b.place;
      });
      body.append(...rows.map(({row}) => row));
    });
  });
}
