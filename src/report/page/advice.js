// A wish, and the cell that fulfils it at the least cost.

class Adviser {
  /** `chart` says which cells there are and what they cost. */
  constructor(chart) {
    this.chart = chart;
    this.wish = make("input", { type: "number", min: 0, max: 1, step: 0.01, input: () => this.show() });
    this.answer = make("p", { role: "status" });
    const label = make("label", { class: "choice" }, make("span", {}, "Advice: least time for an accuracy of at least"), this.wish);
    this.element = make("div", { class: "advice" }, label, this.answer);
  }

  /** What the most accurate cell surely reaches. */
  usual(shown) {
    const best = shown.reduce((a, b) => (cells.accuracy[b] > cells.accuracy[a] ? b : a));
    return Math.floor(100 * cells.low[best]) / 100;
  }

  show() {
    const { shown } = this.chart;
    if (this.wish.value === "") this.wish.value = this.usual(shown);
    const wanted = Number(this.wish.value);
    const cheapest = (column) => shown.filter((cell) => column[cell] >= wanted).reduce((a, b) => (a === null || this.chart.seconds(b) < this.chart.seconds(a) ? b : a), null);
    const [choice, certain] = [cheapest(cells.accuracy), cheapest(cells.low)];
    this.element.dataset.cell = choice === null ? "" : cells.cell[choice];
    if (choice === null) {
      const most = Math.max(...shown.map((cell) => cells.accuracy[cell]));
      this.answer.textContent = `No cell shown here is that accurate; the most accurate reaches ${most.toFixed(3)}.`;
      return;
    }
    const words = (cell) => `${place(cell)} (cell ${cells.cell[cell]}): ${accuracyText(cell)} for ${duration(this.chart.seconds(cell))}`;
    const surely = certain === null ? " No cell’s whole interval reaches it." : certain === choice ? "" : ` With the whole interval above it: ${words(certain)}.`;
    this.answer.replaceChildren(make("strong", {}, words(choice)), `.${surely}`);
  }
}
