// Which rows of a table are shown: for each column that varies, the values that a reader wants.

const MOST_CHIPS = 24;

class Filter {
  constructor(table, changed) {
    Object.assign(this, { table, changed, chosen: new Map() });
    this.columns = table.columns.filter((column) => column.varies && (column.isSwept || (column.role === "outcome" && !column.isNumber)));
    this.state = make("span", { class: "state" });
    this.groups = make("div", { class: "chips" });
    const reset = make("button", { type: "button", class: "plain", click: () => this.all() }, "Choose everything");
    this.element = make("details", { class: "filter", toggle: () => this.show() }, make("summary", {}, "Filter", this.state), this.groups, reset);
    this.element.hidden = this.columns.length === 0;
    this.show();
  }

  /** Leaves one value of a column, by its number among its levels; or all. */
  only(column, level) {
    level === undefined ? this.chosen.delete(column) : this.chosen.set(column, new Set([level]));
  }

  all() {
    this.chosen.clear();
    this.show();
    this.changed();
  }

  toggle(column, level) {
    const all = column.levels.each.map((_, number) => number);
    const chosen = this.chosen.get(column) ?? new Set(all);
    chosen.has(level) ? chosen.delete(level) : chosen.add(level);
    // With nothing chosen there would be nothing to see.
    if (chosen.size === 0 || chosen.size === all.length) this.chosen.delete(column);
    else this.chosen.set(column, chosen);
    this.show();
    this.changed();
  }

  show() {
    const said = [...this.chosen].map(([column, levels]) => `${column.words} ${[...levels].sort((a, b) => a - b).slice(0, 6).map((level) => column.levels.labels[level]).join(", ")}${levels.size > 6 ? " …" : ""}`);
    this.state.textContent = said.length ? said.join(" · ") : "all rows";
    // Chips cost time and are made when they are wanted.
    if (this.element.open) this.groups.replaceChildren(...this.columns.map((column) => this.group(column)));
  }

  group(column) {
    const { labels } = column.levels;
    const chosen = this.chosen.get(column);
    const name = column.words;
    if (labels.length > MOST_CHIPS) {
      const options = [[undefined, "all"], ...labels.map((label, level) => [level, label])];
      const { select } = choice(name, options, chosen && [...chosen][0], (level) => {
        this.only(column, level);
        this.show();
        this.changed();
      });
      select.setAttribute("aria-label", name);
      return make("div", { class: "chip-group" }, make("span", { class: "name" }, name), select);
    }
    const chips = labels.map((label, level) =>
      make("button", { type: "button", class: "chip", "aria-pressed": String(!chosen || chosen.has(level)), click: () => this.press(column, level) }, label));
    return make("div", { class: "chip-group", role: "group", "aria-label": name }, make("span", { class: "name" }, name), ...chips);
  }

  /** Chips are made again; the focus stays where it was. */
  press(column, level) {
    this.toggle(column, level);
    const group = [...this.groups.children].find((one) => one.getAttribute("aria-label") === column.words);
    group?.querySelectorAll(".chip")[level]?.focus();
  }

  rows() {
    const tests = [...this.chosen].map(([column, levels]) => [column.levels.codes, levels]);
    return this.table.all.filter((row) => tests.every(([codes, levels]) => levels.has(codes[row])));
  }
}
