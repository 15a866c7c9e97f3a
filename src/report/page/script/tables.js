// Tables: rows can be sorted, searched, and saved as CSV with the digits of the files.

function sortable(table) {
  const body = table.tBodies[0];
  const rows = [...body.rows];
  const heads = [...table.tHead.rows[0].cells];
  const [count, search] = [make("p", { class: "quiet", role: "status" }), make("input", { type: "search", input: show })];

  /** The fields of the file that a cell holds. */
  function field(row, place) {
    const cell = row.cells[place];
    return cell?.dataset.v ?? heads[place].dataset.v ?? cell.textContent;
  }

  function show() {
    const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const isFound = (row) => words.every((word) => row.textContent.toLowerCase().includes(word));
    rows.forEach((row) => { row.hidden = !isFound(row); });
    count.textContent = `${rows.filter((row) => !row.hidden).length} of ${rows.length} rows`;
  }

  /** Numbers by their digits, words by the alphabet, better ones first; rows without a value come last. */
  function sortBy(head, place) {
    const isDown = head.hasAttribute("aria-sort") ? head.getAttribute("aria-sort") === "ascending" : "down" in head.dataset;
    heads.forEach((other) => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", isDown ? "descending" : "ascending");
    const isWord = head.classList.contains("word");
    const keys = new Map(rows.map((row) => [row, isWord ? field(row, place) : parseFloat(field(row, place))]));
    const isAbsent = (key) => key === "" || Number.isNaN(key);
    const order = (a, b) => (isWord ? a.localeCompare(b, "en", { numeric: true }) : a - b) * (isDown ? -1 : 1);
    const compare = (a, b) => isAbsent(a) - isAbsent(b) || (isAbsent(a) ? 0 : order(a, b));
    rows.sort((a, b) => compare(keys.get(a), keys.get(b)) || a.dataset.row - b.dataset.row);
    body.append(...rows);
  }

  /** The rows that are shown, in their order, with the columns and the fields of the file. */
  function csv() {
    const quoted = (value) => (/[",\n\r]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value);
    const line = (row) => {
      const fields = [];
      heads.forEach((head, place) => {
        const held = head.dataset.held.split(" ");
        const value = field(row, place);
        const values = held.length > 1 ? value.split(" ") : [value];
        held.forEach((column, number) => { fields[column] = quoted(values[number] ?? ""); });
      });
      return fields.join();
    };
    return [table.dataset.columns, ...rows.filter((row) => !row.hidden).map(line)].join("\n") + "\n";
  }

  function save() {
    const link = make("a", { href: URL.createObjectURL(new Blob([csv()], { type: "text/csv" })), download: table.dataset.table });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }

  heads.forEach((head, place) => head.replaceChildren(make("button", { type: "button", click: () => sortBy(head, place) }, ...head.childNodes)));
  const label = make("label", { class: "search" }, "Rows with ", search);
  table.parentNode.after(make("div", { class: "below" }, count, label, make("button", { type: "button", click: save }, "Save as CSV")));
  show();
}

document.querySelectorAll("table[data-table]").forEach(sortable);
