// Accuracy along a setting: lines for a second one, panels for a third; all others stay where the best cell has them.

/** Lines up to which bands do not hide each other. */
const MOST_BANDS = 4;

class AccuracyChart {
  constructor(host) {
    this.host = host;
    const { x, lines, panels } = study.start;
    this.roles = { x, lines, panels };
    this.fitted = 0;
    this.filter = new Filter(axes.map((_, axis) => this.usual(axis)), () => this.show());
    this.charts = make("div", { class: "panels" });
    this.legend = make("div", { class: "legend" });
    this.note = make("p", { class: "quiet" });
    host.append(this.controls(), this.filter.element, this.legend, this.charts, this.note);
    this.show();
  }

  controls() {
    const named = (among) => among.map((axis) => [axis, axes[axis].name]);
    const along = axes.map((_, axis) => axis).filter((axis) => !axes[axis].follows || axes[axis].instead !== null);
    const none = [[-1, "none"]];
    const role = (name) => (axis) => this.give(name, axis);
    this.selects = {
      x: choice("Along x", named(along), this.roles.x, role("x")),
      lines: choice("Lines", none.concat(named(free)), this.roles.lines, role("lines")),
      panels: choice("Panels", none.concat(named(free)), this.roles.panels, role("panels")),
    };
    const range = choice("Accuracy axis", [[0, "0 to 1"], [1, "fitted"]], 0, (fitted) => {
      this.fitted = fitted;
      this.show();
    });
    const choices = [...Object.values(this.selects), range].map((one) => one.element);
    return make("div", { class: "controls" }, ...choices);
  }

  /** Whether a place in the chart tells an axis's values apart; an axis along x stands for the one that follows from it. */
  isPlaced(axis) {
    const { x, lines, panels } = this.roles;
    return [x, lines, panels].includes(axis) || (x >= 0 && axes[x].instead === axis);
  }

  /** All values of an axis that has a place, of others the one that they keep. */
  usual(axis) {
    return axes[axis].labels.map((_, level) => this.isPlaced(axis) || level === axes[axis].base);
  }

  /** Gives an axis a role; who had it takes the role's old axis instead. */
  give(role, axis) {
    const before = axes.map((_, other) => this.isPlaced(other));
    const old = this.roles[role];
    const isSame = (a, b) => a >= 0 && b >= 0 && (a === b || axes[a].instead === b || axes[b].instead === a);
    this.roles[role] = axis;
    for (const other of Object.keys(this.roles)) {
      if (other !== role && isSame(this.roles[other], axis)) this.roles[other] = old >= 0 && axes[old].follows ? axes[old].instead : old;
    }
    // Something has to run along x.
    if (this.roles.x < 0) this.roles.x = free.find((one) => one !== axis && one !== this.roles.lines && one !== this.roles.panels) ?? axis;
    if (this.roles.x === axis && role !== "x") this.roles[role] = -1;
    for (const [name, { select }] of Object.entries(this.selects)) select.value = this.roles[name];
    axes.forEach((_, other) => {
      if (this.isPlaced(other) !== before[other]) this.filter.set(other, this.usual(other));
    });
    this.show();
  }

  /** The cells of a panel as lines: each goes through cells that differ in what runs along x alone. */
  linesOf(shown, level) {
    const { x, lines, panels } = this.roles;
    const rest = free.filter((axis) => axis !== x && axis !== panels && axes[x].instead !== axis);
    const found = new Map();
    for (const cell of shown) {
      if (panels >= 0 && levelOf(panels, cell) !== level) continue;
      const key = rest.map((axis) => levelOf(axis, cell)).join();
      if (!found.has(key)) found.set(key, { look: lines < 0 ? found.size : levelOf(lines, cell), cells: [] });
      found.get(key).cells.push(cell);
    }
    const number = (cell) => levelOf(x, cell);
    for (const line of found.values()) line.cells.sort((a, b) => number(a) - number(b));
    return [...found.values()];
  }

  show() {
    hideTip();
    const shown = this.filter.cells();
    const { panels } = this.roles;
    const present = (axis) => axes[axis].labels.map((_, level) => level).filter((level) => shown.some((cell) => levelOf(axis, cell) === level));
    const levels = panels < 0 ? [null] : present(panels);
    const drawn = levels.map((level) => ({ level, lines: this.linesOf(shown, level) }));
    const most = Math.max(0, ...drawn.map(({ lines }) => lines.length));
    const columns = { 1: 1, 2: 2, 4: 2 }[levels.length] || 3;
    const room = roomOf(this.host);
    const width = Math.max(290, Math.min(room, Math.floor(room / Math.min(columns, Math.max(1, Math.floor(room / 300))))));
    const ranges = (column) => shown.map((cell) => column[cell]);
    const style = {
      width,
      height: Math.round(Math.min(380, Math.max(250, 0.62 * width))),
      range: accuracyRange(ranges(cells.low), ranges(cells.high), this.fitted === 1),
      xLevels: present(this.roles.x),
      bands: most <= MOST_BANDS && axes[this.roles.x].scale !== "words",
    };
    this.charts.style.setProperty("--width", `${width}px`);
    this.charts.replaceChildren(...drawn.map((one) => this.panel(one, style)));
    this.showLegend(drawn, style.bands);
    const alike = drawn.some(({ lines }) => new Set(lines.map((line) => line.look)).size < lines.length);
    this.note.textContent = shown.length === 0 ? "No cell has all of the chosen values: choose more in the filter."
      : alike ? "Lines of one colour differ in settings that the filter leaves open: point at them." : "";
  }

  panel({ level, lines }, style) {
    const { x, panels } = this.roles;
    const at = valueScale(x, style.xLevels, 52, style.width - 12);
    const title = level === null ? null : axes[panels].phrases[level];
    const drawn = panel({
      ...style,
      ticks: style.xLevels.map((value) => [at(value), axes[x].ticks[value]]),
      xTitle: axes[x].title,
      title,
      label: `Accuracy by ${axes[x].name}${title ? ", " + title : ""}: ${lines.length} lines`,
    });
    const points = [];
    lines.forEach((line, number) => {
      const beside = style.bands ? 0 : Math.min(axes[x].scale === "words" ? 12 : 2, 30 / lines.length) * (number - (lines.length - 1) / 2);
      const places = line.cells.map((cell) => ({
        x: at(levelOf(x, cell)) + beside, y: drawn.at(cells.accuracy[cell]),
        low: drawn.at(Math.max(cells.low[cell], style.range.low)), high: drawn.at(cells.high[cell]), cell, line: number,
      }));
      drawn.svg.append(...this.line(places, line.look, style.bands));
      points.push(...places);
    });
    for (const point of points) drawn.svg.append(marker(lines[point.line].look, point.x, point.y));
    letAsk(drawn.svg, points);
    return drawn.svg;
  }

  /** The interval of each point as a band or a whisker, and the line through them. */
  line(points, number, bands) {
    const { colour, dashes } = look(number);
    const path = (y) => points.map((point) => `${point.x.toFixed(1)},${point[y].toFixed(1)}`);
    const shapes = [];
    if (bands && points.length > 1) {
      const d = `M${path("low").join("L")}L${path("high").reverse().join("L")}z`;
      shapes.push(draw("path", { d, fill: colour, class: "band" }));
    } else {
      const d = points.map((point) => `M${point.x.toFixed(1)},${point.low.toFixed(1)}V${point.high.toFixed(1)}`).join("");
      shapes.push(draw("path", { d, stroke: colour, class: "whisker" }));
    }
    // Between words there is nothing, so nothing is drawn there.
    if (axes[this.roles.x].scale !== "words") {
      shapes.push(draw("path", { d: `M${path("y").join("L")}`, stroke: colour, class: "line", "stroke-dasharray": dashes }));
    }
    return shapes;
  }

  showLegend(drawn, bands) {
    const { lines } = this.roles;
    const looks = [...new Set(drawn.flatMap((one) => one.lines.map((line) => line.look)))].sort((a, b) => a - b);
    const entries = lines < 0 ? [] : looks.map((number) => {
      const { colour, dashes } = look(number);
      return legendEntry(axes[lines].labels[number], draw("path", { d: "M-13,0H13", stroke: colour, class: "line", "stroke-dasharray": dashes }), marker(number, 0, 0));
    });
    if (lines >= 0) entries.unshift(make("span", { class: "name" }, `${axes[lines].heading}:`));
    entries.push(bands ? legendEntry("95 % interval", draw("path", { d: "M-13,-6H13V6H-13z", fill: "var(--c0)", class: "band" }))
      : legendEntry("95 % interval", draw("path", { d: "M0,-8V8", stroke: "var(--c0)", class: "whisker" })));
    if (study.chance !== null) entries.push(chanceEntry());
    this.legend.replaceChildren(...entries);
  }
}
