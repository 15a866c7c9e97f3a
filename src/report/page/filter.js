// Chips for the values of axes: which cells a chart or a table shows.

class Filter {
  /** `chosen[axis][level]` says what is on at first; `changed` is called after each change. */
  constructor(chosen, changed) {
    this.chosen = chosen;
    this.changed = changed;
    this.state = make("span", { class: "state" });
    this.groups = make("div", { class: "chips" });
    const reset = make("button", { type: "button", class: "plain", click: () => this.all() }, "Choose everything");
    const summary = make("summary", {}, "Filter", this.state);
    this.element = make("details", { class: "filter" }, summary, this.groups, reset);
    this.chips = free.map((axis) => this.group(axis));
    this.show();
  }

  static everything() {
    return axes.map((axis) => axis.labels.map(() => true));
  }

  group(axis) {
    const chips = axes[axis].labels.map((label, level) =>
      make("button", { type: "button", class: "chip", click: () => this.toggle(axis, level) }, label));
    const name = axes[axis].heading;
    const fields = make("div", { class: "chip-group", role: "group", "aria-label": name }, make("span", { class: "name" }, name), ...chips);
    this.groups.append(fields);
    return { axis, chips };
  }

  toggle(axis, level) {
    const chosen = this.chosen[axis];
    chosen[level] = !chosen[level];
    // With nothing chosen there would be nothing to see.
    if (!chosen.includes(true)) chosen.fill(true);
    this.show();
    this.changed();
  }

  all() {
    for (const chosen of this.chosen) chosen.fill(true);
    this.show();
    this.changed();
  }

  set(axis, chosen) {
    this.chosen[axis] = chosen;
    this.show();
  }

  show() {
    const said = [];
    for (const { axis, chips } of this.chips) {
      const chosen = this.chosen[axis];
      chips.forEach((chip, level) => chip.setAttribute("aria-pressed", chosen[level]));
      if (chosen.includes(false)) {
        const labels = axes[axis].labels.filter((_, level) => chosen[level]);
        said.push(`${axes[axis].name} ${labels.join(", ")}`);
      }
    }
    this.element.classList.toggle("open-all", said.length === 0);
    this.state.textContent = said.length ? said.join(" · ") : "all cells";
  }

  cells() {
    return allCells.filter((cell) => free.every((axis) => this.chosen[axis][levelOf(axis, cell)]));
  }
}
