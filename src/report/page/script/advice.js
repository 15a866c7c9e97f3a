// A wish, and for each condition of the world the choice that fulfils it: the least cost for a value, or the best value within a budget.

class Adviser {
  constructor(host, table) {
    this.table = table;
    this.values = table.columns.filter((column) => column.role === "value" && column.better !== "neither" && column.isNumber && column.varies);
    this.costs = table.columns.filter((column) => column.role === "cost" && column.isNumber && column.varies);
    [this.value, this.cost, this.isBudget] = [this.values[0], this.costs[0], false];
    const named = (columns) => columns.map((column) => [column, column.title]);
    const set = (name) => (chosen) => {
      this[name] = chosen;
      this.show(true);
    };
    this.wish = make("input", { type: "number", step: "any", input: () => this.show(false) });
    this.label = make("span", {});
    this.answer = make("div", { role: "status", tabindex: 0, "aria-label": "Advice" });
    const wishes = [[false, "the least cost that reaches a value"], [true, "the best value within a budget"]];
    const choices = [choice("Advice:", wishes, false, set("isBudget")), choice("value", named(this.values), this.value, set("value")), choice("cost", named(this.costs), this.cost, set("cost"))];
    this.element = make("div", { class: "advice" }, ...choices.map(({ element }) => element), make("label", { class: "choice" }, this.label, this.wish), this.answer);
    host.append(this.element);
    this.show(true);
  }

  /** Whether a table has something to choose, and a row is a choice. */
  static canAdvise(table) {
    const has = (role, test = () => true) => table.columns.some((column) => column.role === role && column.varies && test(column));
    return has("choice") && has("value", (column) => column.better !== "neither" && column.isNumber) && has("cost", (column) => column.isNumber) && !has("subject");
  }

  /** In the unit in which values are shown. */
  factor(column) {
    return column.unit === "%" ? 100 : 1;
  }

  isBetter(a, b) {
    return this.value.better === "less" ? a < b : a > b;
  }

  best(rows) {
    return rows.reduce((a, b) => (a === null || this.isBetter(this.value.value(b), this.value.value(a)) ? b : a), null);
  }

  /** The end of the value's interval that is worse: what a row surely reaches. */
  surely(row) {
    const ends = this.value.interval?.map((name) => this.table.column(name));
    const end = ends?.[this.value.better === "less" ? 1 : 0]?.value(row);
    return end ?? this.value.value(row);
  }

  /** What the best of every condition surely reaches; of budgets, the middle one. */
  usual() {
    const rows = this.rows();
    if (this.isBudget) {
      const costs = rows.map((row) => this.cost.value(row)).sort((a, b) => a - b);
      return Number(costs[Math.floor(costs.length / 2)].toPrecision(3));
    }
    const reached = this.table.byCondition(rows).map((one) => this.surely(this.best(one.rows)));
    return reached.reduce((a, b) => (this.isBetter(a, b) ? b : a));
  }

  rows() {
    return this.table.all.filter((row) => !this.value.isAbsent(row) && !this.cost.isAbsent(row));
  }

  /** Of rows that fulfil the wish, the one to choose; of equals the better, then the cheaper. */
  choose(rows, of) {
    const [value, cost] = [(row) => this.value.value(row), (row) => this.cost.value(row)];
    const fits = rows.filter((row) => (this.isBudget ? cost(row) <= this.wished : !this.isBetter(this.wished, of(row))));
    const less = (a, b) => cost(a) - cost(b);
    const more = (a, b) => (this.isBetter(value(a), value(b)) ? -1 : this.isBetter(value(b), value(a)) ? 1 : 0);
    const order = this.isBudget ? (a, b) => more(a, b) || less(a, b) : (a, b) => less(a, b) || more(a, b);
    return fits.reduce((a, b) => (a === null || order(b, a) < 0 ? b : a), null);
  }

  show(isNew) {
    const of = this.isBudget ? this.cost : this.value;
    if (isNew) {
      const exact = this.factor(of) * this.usual();
      const round = of.better === "more" ? Math.floor : Math.ceil;
      this.wish.value = of.scale === "share" ? round(exact * 100 + (of.better === "more" ? 1e-9 : -1e-9)) / 100 : Number(exact.toPrecision(3));
    }
    const bound = this.isBudget || this.value.better === "less" ? "at most" : "at least";
    this.label.textContent = `${of.words} ${bound}${of.unit && of.unit !== ":1" ? ` (${of.unit})` : ""}`;
    this.wished = Number(this.wish.value) / this.factor(of);
    const advice = this.table.byCondition(this.rows()).map((one) => ({ ...one, row: this.choose(one.rows, (row) => this.value.value(row)), sure: this.choose(one.rows, (row) => this.surely(row)) }));
    this.element.dataset.rows = advice.map(({ row }) => row ?? "").join();
    this.answer.replaceChildren(...advice.map((one) => this.line(one)));
  }

  line({ rows, words, row, sure }) {
    const { table } = this;
    const head = words ? `With ${words}: ` : "";
    const said = (row) => `${table.place(row, ["condition"])}: ${this.value.words} ${table.bounded(this.value, row)} for ${this.cost.words} ${this.cost.say(this.cost.value(row))}`;
    if (row === null) return make("p", {}, `${head}nothing here fulfils that; the best is ${said(this.best(rows))}.`);
    const surely = this.isBudget || !this.value.interval ? "" : sure === null ? " No whole interval reaches it." : sure === row ? "" : ` With the whole interval: ${said(sure)}.`;
    return make("p", {}, head, make("strong", {}, said(row)), `.${surely}`);
  }
}
