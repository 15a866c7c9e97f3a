// All cells in a table that can be sorted and filtered.

const PAGE = 50;

class CellTable {
  constructor(host) {
    this.columns = this.allColumns();
    this.sorted = { column: 0, down: false };
    this.n = PAGE;
    this.filter = new Filter(Filter.everything(), () => {
      this.n = PAGE;
      this.show();
    });
    this.heads = this.columns.map((column, number) => this.head(column, number));
    this.body = make("tbody");
    const caption = make("caption", { class: "unseen" }, "All cells");
    const table = make("table", {}, caption, make("thead", {}, make("tr", {}, ...this.heads)), this.body);
    this.count = make("p", { class: "quiet", role: "status" });
    this.more = make("button", { type: "button", click: () => this.showMore() }, "");
    const frame = make("div", { class: "wide", tabindex: 0, role: "region", "aria-label": "Table of all cells" }, table);
    host.append(this.filter.element, frame, make("div", { class: "below" }, this.count, this.more));
    this.show();
  }

  allColumns() {
    const score = (title, values, text) => ({ title, value: (cell) => values[cell], text: (cell) => (values[cell] === null ? "" : text(values[cell], cell)) });
    const setting = (axis, number) => ({
      title: axis.heading, value: (cell) => levelOf(number, cell), text: (cell) => axis.labels[levelOf(number, cell)], setting: true,
    });
    return [
      { title: "cell", value: (cell) => cells.cell[cell], text: (cell) => String(cells.cell[cell]) },
      ...axes.map(setting),
      score("accuracy [95 %]", cells.accuracy, (_, cell) => accuracyText(cell)),
      score("macro-F1", cells.f1, (f1) => f1.toFixed(3)),
      score("to the best", cells.difference, (difference) => signed(difference, 3)),
      score(study.p, cells.p, chanceValue),
      score("decision", cells.decide_us, (us) => duration(1e-6 * us)),
      score("training", cells.fit_s, duration),
      { title: "remark", value: (cell) => this.rank(cell), text: (cell) => ["best", "as good", ""][this.rank(cell)], setting: true },
    ].filter((column) => allCells.some((cell) => column.text(cell) !== ""));
  }

  rank(cell) {
    if (cell === cells.best[cell]) return 0;
    return cells.accuracy[cell] >= cells.low[cells.best[cell]] ? 1 : 2;
  }

  head(column, number) {
    const arrow = make("span", { "aria-hidden": "true", class: "arrow" });
    const button = make("button", { type: "button", click: () => this.sortBy(number) }, column.title, arrow);
    return make("th", { scope: "col", class: column.setting ? "word" : null }, button);
  }

  sortBy(column) {
    // Numbers that are better when larger come largest first.
    const first = this.columns[column].title.startsWith("accuracy") || this.columns[column].title === "macro-F1";
    const down = this.sorted.column === column ? !this.sorted.down : first;
    this.sorted = { column, down };
    this.show();
  }

  showMore() {
    this.n += 10 * PAGE;
    this.show();
  }

  show() {
    const { column, down } = this.sorted;
    const value = this.columns[column].value;
    const absent = (cell) => value(cell) === null;
    const order = (a, b) => absent(a) - absent(b) || (down ? value(b) - value(a) : value(a) - value(b)) || a - b;
    const shown = this.filter.cells().sort(order);
    this.body.replaceChildren(...shown.slice(0, this.n).map((cell) => this.row(cell)));
    this.heads.forEach((head, number) => {
      const order = number === column ? (down ? "descending" : "ascending") : null;
      order ? head.setAttribute("aria-sort", order) : head.removeAttribute("aria-sort");
      head.querySelector(".arrow").textContent = { ascending: "▲", descending: "▼" }[order] || "";
    });
    const n = Math.min(this.n, shown.length);
    this.count.textContent = n < shown.length ? `${n} of ${shown.length} cells` : `${shown.length} of ${allCells.length} cells`;
    this.more.textContent = `Show ${Math.min(10 * PAGE, shown.length - n)} more`;
    this.more.hidden = n === shown.length;
  }

  row(cell) {
    const row = make("tr", { class: cell === cells.best[cell] ? "best" : null });
    for (const column of this.columns) row.append(make("td", { class: column.setting ? "word" : null }, column.text(cell)));
    return row;
  }
}
