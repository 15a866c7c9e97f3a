// Tables that can be sorted, filtered and taken away as CSV.

const PAGE = 50;

class TableView {
  constructor(host, table) {
    Object.assign(this, { table, sorted: null, n: PAGE });
    this.columns = table.columns.filter((column) => !this.bounds().has(column.name));
    this.filter = new Filter(table, () => {
      this.n = PAGE;
      this.show();
    });
    this.heads = this.columns.map((column) => this.head(column));
    this.body = make("tbody");
    const caption = make("caption", { class: "unseen" }, table.title);
    const grid = make("table", {}, caption, make("thead", {}, make("tr", {}, ...this.heads)), this.body);
    this.count = make("p", { class: "quiet", role: "status" });
    this.more = make("button", { type: "button", click: () => this.showMore() }, "");
    const csv = make("button", { type: "button", click: () => this.save() }, "Save as CSV");
    const frame = make("div", { class: "wide", tabindex: 0, role: "region", "aria-label": table.title }, grid);
    host.append(this.filter.element, frame, make("div", { class: "below" }, this.count, this.more, csv));
    this.show();
  }

  /** Ends of intervals stand beside their values. */
  bounds() {
    return new Set(this.table.columns.flatMap((column) => column.interval ?? []));
  }

  head(column) {
    const arrow = make("span", { "aria-hidden": "true", class: "arrow" });
    const button = make("button", { type: "button", title: column.name, click: () => this.sortBy(column) }, column.title, arrow);
    return make("th", { scope: "col", class: column.isNumber ? null : "word" }, button);
  }

  /** What is better comes first. */
  sortBy(column) {
    const down = this.sorted?.column === column ? !this.sorted.down : column.better === "more";
    this.sorted = { column, down };
    this.show();
  }

  showMore() {
    this.n += 10 * PAGE;
    this.show();
  }

  rows() {
    const rows = this.filter.rows();
    if (!this.sorted) return rows;
    const { column, down } = this.sorted;
    const value = column.isNumber ? (row) => column.value(row) : (row) => column.levels.codes[row];
    return rows.sort((a, b) => column.isAbsent(a) - column.isAbsent(b) || (column.isAbsent(a) ? 0 : down ? value(b) - value(a) : value(a) - value(b)) || a - b);
  }

  show() {
    const shown = this.rows();
    const cell = (column, row) => make("td", { class: column.isNumber ? null : "word" }, column.isAbsent(row) ? "" : this.table.bounded(column, row));
    this.body.replaceChildren(...shown.slice(0, this.n).map((row) => make("tr", { "data-row": row }, ...this.columns.map((column) => cell(column, row)))));
    this.heads.forEach((head, number) => {
      const order = this.columns[number] === this.sorted?.column ? (this.sorted.down ? "descending" : "ascending") : null;
      order ? head.setAttribute("aria-sort", order) : head.removeAttribute("aria-sort");
      head.querySelector(".arrow").textContent = { ascending: "▲", descending: "▼" }[order] || "";
    });
    const n = Math.min(this.n, shown.length);
    this.count.textContent = n < shown.length ? `${n} of ${shown.length} rows` : `${shown.length} of ${this.table.n} rows`;
    this.more.textContent = `Show ${Math.min(10 * PAGE, shown.length - n)} more`;
    this.more.hidden = n === shown.length;
  }

  /** The rows that are shown, in their order, with all columns. */
  csv() {
    const quoted = (value) => (/[",\n]/.test(value) ? `"${value.replaceAll('"', '""')}"` : value);
    const line = (row) => this.table.columns.map((column) => quoted(String(column.value(row) ?? ""))).join();
    return [this.table.columns.map((column) => column.name).join(), ...this.rows().map(line)].join("\n") + "\n";
  }

  save() {
    const link = make("a", { href: URL.createObjectURL(new Blob([this.csv()], { type: "text/csv" })), download: this.table.file });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  }
}
