// A wish, and for each condition of the world the cell that fulfils it at the least cost. The command's advice is the same.

const COSTS = [
  { name: "time of a decision", of: (cell) => cells.decide_us[cell], words: (us) => `${duration(1e-6 * us)} a decision` },
  { name: "time to train", of: (cell) => cells.fit_s[cell], words: (s) => `${duration(s)} to train` },
  { name: "taxels", of: (cell) => cells.taxels[cell], words: (n) => `${n} taxels` },
  { name: "measurements", of: (cell) => cells.measurements[cell], words: (n) => `${n} measurements a decision` },
];

class Adviser {
  /** `chart` says which cells there are. */
  constructor(chart) {
    this.chart = chart;
    this.cost = COSTS[0];
    const costs = choice("Advice: least", COSTS.map(({ name }, number) => [number, name]), 0, (number) => {
      this.cost = COSTS[number];
      this.show();
    });
    this.wish = make("input", { type: "number", min: 0, max: 1, step: 0.01, input: () => this.show() });
    const label = make("label", { class: "choice" }, make("span", {}, "for an accuracy of at least"), this.wish);
    this.answer = make("div", { role: "status", tabindex: 0, "aria-label": "Advice" });
    this.element = make("div", { class: "advice" }, costs.element, label, this.answer);
  }

  /** What the most accurate cell of every condition surely reaches. */
  usual(shown) {
    const best = (condition) => condition.reduce((a, b) => (cells.accuracy[b] > cells.accuracy[a] ? b : a));
    return Math.floor(100 * Math.min(...byCondition(shown).map((condition) => cells.low[best(condition)]))) / 100;
  }

  /** The cell of least cost whose value in a column is enough, of equal costs the more accurate; none if none is enough. */
  cheapest(condition, column, wanted) {
    const less = (a, b) => this.cost.of(a) - this.cost.of(b) || cells.accuracy[b] - cells.accuracy[a];
    return condition.filter((cell) => column[cell] >= wanted).reduce((a, b) => (a === null || less(b, a) < 0 ? b : a), null);
  }

  show() {
    const { shown } = this.chart;
    if (this.wish.value === "") this.wish.value = this.usual(shown);
    const wanted = Number(this.wish.value);
    const advice = byCondition(shown).map((condition) => ({
      condition,
      cell: this.cheapest(condition, cells.accuracy, wanted),
      certain: this.cheapest(condition, cells.low, wanted),
    }));
    this.element.dataset.cell = advice.map(({ cell }) => (cell === null ? "" : cells.cell[cell])).join();
    this.answer.replaceChildren(...advice.map((one) => this.line(one)));
  }

  line({ condition, cell, certain }) {
    const head = severalConditions ? `With ${study.conditions[cells.condition[condition[0]]]}: ` : "";
    if (cell === null) {
      const most = Math.max(...condition.map((other) => cells.accuracy[other]));
      return make("p", {}, `${head}no cell shown here is that accurate; the most accurate reaches ${most.toFixed(3)}.`);
    }
    const words = (other) => `${choicesOf(other)} (cell ${cells.cell[other]}): ${accuracyText(other)} for ${this.cost.words(this.cost.of(other))}`;
    const surely = certain === null ? " No cell’s whole interval reaches it." : certain === cell ? "" : ` With the whole interval above it: ${words(certain)}.`;
    return make("p", {}, head, make("strong", {}, words(cell)), `.${surely}`);
  }
}
