// Accuracy against time, and the front: cells that no other one beats in both.

class ParetoChart {
  constructor(host) {
    this.host = host;
    this.cost = 0;
    this.colour = study.start.colour;
    this.filter = new Filter(Filter.everything(), () => this.show());
    this.chart = make("div", { class: "panels" });
    this.legend = make("div", { class: "legend" });
    const costs = choice("Time", [[0, "to decide once"], [1, "to train"]], 0, (cost) => {
      this.cost = cost;
      this.show();
    });
    const colours = choice("Colours", [[-1, "none"], ...free.map((axis) => [axis, axes[axis].name])], this.colour, (axis) => {
      this.colour = axis;
      this.show();
    });
    this.adviser = new Adviser(this);
    const controls = make("div", { class: "controls" }, costs.element, colours.element);
    host.append(controls, this.filter.element, this.adviser.element, this.legend, this.chart);
    this.show();
  }

  /** Seconds; a clock that saw no time pass cannot stand on a logarithmic axis. */
  seconds(cell) {
    return Math.max(this.cost === 0 ? 1e-6 * cells.decide_us[cell] : cells.fit_s[cell], 1e-9);
  }

  /** The fronts, from left to right: one for each condition, since nobody chooses how noisy the world is. */
  fronts(shown) {
    return byCondition(shown).map((condition) => {
      const order = condition.sort((a, b) => this.seconds(a) - this.seconds(b) || cells.accuracy[b] - cells.accuracy[a]);
      let best = -1;
      return order.filter((cell, place) => {
        const twin = place > 0 && this.seconds(order[place - 1]) === this.seconds(cell) && cells.accuracy[cell] === best;
        const better = cells.accuracy[cell] > best || twin;
        best = Math.max(best, cells.accuracy[cell]);
        return better;
      });
    });
  }

  show() {
    hideTip();
    const shown = this.filter.cells().filter((cell) => cells.decide_us[cell] !== null);
    this.shown = shown;
    this.chart.replaceChildren();
    if (shown.length === 0) {
      this.chart.append(make("p", { class: "quiet" }, "No cell has all of the chosen values."));
      return;
    }
    const width = roomOf(this.host);
    const height = Math.round(Math.min(460, Math.max(280, 0.5 * width)));
    const scale = timeScale(shown.map((cell) => this.seconds(cell)), 52, width - 12);
    const xTitle = this.cost === 0 ? "time of one decision, its touches measured" : "time of one fit, all training touches";
    const range = accuracyRange([0], [1], false);
    const label = `Accuracy against the ${xTitle}: ${shown.length} cells`;
    const drawn = panel({ width, height, ticks: scale.ticks, range, xTitle, label });
    const fronts = this.fronts(shown);
    const onFront = new Set(fronts.flat());
    const point = (cell) => ({ x: scale.at(this.seconds(cell)), y: drawn.at(cells.accuracy[cell]), cell, line: onFront.has(cell) ? 0 : 1 });
    drawn.svg.append(...this.clouds(shown.filter((cell) => !onFront.has(cell)).map(point)));
    for (const front of fronts) drawn.svg.append(this.steps(front.map(point), drawn.box.right));
    for (const cell of onFront) {
      const { x, y } = point(cell);
      drawn.svg.append(marker(this.look(cell), x, y, { class: "on-front" }));
    }
    const points = shown.map(point).sort((a, b) => a.line - b.line || a.x - b.x);
    letAsk(drawn.svg, points);
    this.chart.style.setProperty("--width", `${width}px`);
    this.chart.append(drawn.svg);
    this.adviser.show();
    this.showLegend(shown);
  }

  look(cell) {
    return this.colour < 0 ? 0 : levelOf(this.colour, cell);
  }

  /** Cells behind the front, one path a colour: thousands of elements would be slow. */
  clouds(points) {
    const paths = new Map();
    for (const { x, y, cell } of points) {
      const number = this.look(cell);
      paths.set(number, `${paths.get(number) || ""}M${(x - 3).toFixed(1)},${y.toFixed(1)}a3,3 0 1,0 6,0a3,3 0 1,0 -6,0`);
    }
    return [...paths].map(([number, d]) => draw("path", { d, fill: look(number).colour, class: "cloud" }));
  }

  /** What accuracy a budget of time buys: level until the next cell of the front. */
  steps(front, right) {
    const d = front.map(({ x, y }, place) => (place ? `H${x.toFixed(1)}V${y.toFixed(1)}` : `M${x.toFixed(1)},${y.toFixed(1)}`)).join("");
    return draw("path", { d: `${d}H${right}`, class: "front", "data-cells": front.map(({ cell }) => cells.cell[cell]).join() });
  }

  showLegend(shown) {
    const entries = [];
    if (this.colour >= 0) {
      const present = new Set(shown.map((cell) => this.look(cell)));
      entries.push(make("span", { class: "name" }, `${axes[this.colour].heading}:`));
      axes[this.colour].labels.forEach((label, number) => {
        if (present.has(number)) entries.push(legendEntry(label, marker(number, 0, 0)));
      });
    }
    entries.push(legendEntry(severalConditions ? "Pareto front of each condition: nothing is both faster and as accurate" : "Pareto front: nothing is both faster and as accurate", draw("path", { d: "M-13,5H0V-5H13", class: "front" })));
    if (study.chance !== null) entries.push(chanceEntry());
    this.legend.replaceChildren(...entries);
  }
}
