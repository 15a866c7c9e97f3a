// A chart that readers arrange: what runs along x and up, what tells lines and panels apart, which rows are shown.

class Explorer {
  constructor(host, spec) {
    Object.assign(this, { host, spec: structuredClone(spec), fitted: false, table: tableOf(spec.table) });
    this.kind = typeof spec.mark === "string" ? spec.mark : "tiles";
    this.filter = new Filter(this.table, () => this.show());
    for (const { column, value } of spec.shown) {
      const found = this.table.column(column);
      this.filter.only(found, found.levels.each.indexOf(value));
    }
    this.filter.show();
    this.legend = make("div", { class: "legend" });
    this.panels = make("div", { class: "panels" });
    this.said = make("p", { class: "quiet" });
    host.append(this.controls(), this.filter.element, this.legend, this.panels, this.said);
    this.show();
  }

  controls() {
    const named = (columns) => columns.map((column) => [column.name, column.words]);
    const { table, spec } = this;
    const isOf = (...names) => (column) => names.filter(Boolean).includes(column.name);
    const varying = table.columns.filter((column) => column.varies);
    const measured = varying.filter((column) => column.isNumber && ["value", "cost"].includes(column.role));
    const apart = varying.filter((column) => (column.isSwept || isOf(...spec.lines, spec.panels)(column)) && column.levels.each.length <= 40);
    const none = [[null, "none"]];
    const xs = varying.filter((column) => column.isSwept || measured.includes(column) || isOf(spec.x)(column));
    const ys = this.kind === "tiles" ? xs : varying.filter((column) => measured.includes(column) || isOf(spec.y)(column));
    const role = (name) => (value) => this.give(name, value);
    const one = spec.lines.length === 1 ? spec.lines[0] : null;
    const lines = spec.lines.length > 1 ? [[undefined, "as they are"]] : [];
    this.selects = {
      x: choice("Along x", named(xs), spec.x, role("x")),
      y: choice("Up", named(ys), spec.y, role("y")),
      lines: choice(this.kind === "tiles" ? "Rows" : "Lines", [...lines, ...none, ...named(apart)], spec.lines.length > 1 ? undefined : one, role("lines")),
      panels: choice("Panels", none.concat(named(apart)), spec.panels, role("panels")),
    };
    const elements = Object.values(this.selects).map(({ element, select }) => {
      element.hidden = select.options.length < 2;
      return element;
    });
    if (this.kind !== "tiles") {
      elements.push(choice("Axis", [[false, "whole"], [true, "fitted"]], false, (fitted) => {
        this.fitted = fitted;
        this.show();
      }).element);
    }
    return make("div", { class: "controls" }, ...elements);
  }

  /** Gives a column a place; who had it takes the column's old place instead. */
  give(role, name) {
    const { spec } = this;
    const places = { x: spec.x, y: spec.y, lines: spec.lines.length === 1 ? spec.lines[0] : null, panels: spec.panels };
    const old = places[role];
    for (const other of Object.keys(places)) {
      if (other !== role && name && places[other] === name) places[other] = other === "y" ? places.y : old;
    }
    places[role] = name;
    Object.assign(spec, { x: places.x ?? spec.x, y: places.y, panels: places.panels ?? null });
    if (name !== undefined || role !== "lines") spec.lines = places.lines ? [places.lines] : [];
    if (spec.panels && spec.lines.includes(spec.panels)) spec.panels = null;
    this.settle();
    for (const [which, { select }] of Object.entries(this.selects)) {
      const value = { x: spec.x, y: spec.y, lines: spec.lines[0] ?? null, panels: spec.panels }[which];
      const words = value === null ? "none" : this.table.column(value).words;
      select.selectedIndex = [...select.options].findIndex((option) => option.text === words);
    }
    this.show();
  }

  /** Columns without a place that would put several rows at one point keep the value that the best row has. */
  settle() {
    if (this.kind === "points") return;
    const { table, spec, filter } = this;
    const placed = [spec.x, ...spec.lines, spec.panels].filter(Boolean).map((name) => table.column(name));
    for (const column of placed) filter.only(column);
    const y = table.column(spec.y);
    const best = filter.rows().reduce((a, b) => (a === null || (y.better === "less" ? y.value(b) < y.value(a) : y.value(b) > y.value(a)) ? b : a), null);
    const base = best ?? 0;
    for (const column of table.swept.filter((one) => !placed.includes(one))) {
      filter.only(column);
      const known = new Map();
      const isSettled = filter.rows().every((row) => {
        const key = placed.map((one) => one.levels.codes[row]).join();
        if (!known.has(key)) known.set(key, column.levels.codes[row]);
        return known.get(key) === column.levels.codes[row];
      });
      if (!isSettled) filter.only(column, column.levels.codes[base]);
    }
    filter.show();
  }

  show() {
    hideTip();
    this.panels.replaceChildren();
    const rows = this.filter.rows();
    const view = rows.length ? new View(this.spec, this.table, rows, this.fitted) : null;
    if (!view || view.places.length === 0) {
      this.legend.replaceChildren();
      this.panels.append(make("p", { class: "quiet" }, "No row has all of the chosen values."));
      return;
    }
    drawView(view, this.legend, this.panels, roomOf(this.host));
    const lost = rows.length - view.places.length;
    this.said.textContent = lost > 0 ? `${lost} of ${rows.length} rows have no value here.` : "";
  }
}

/** Pixels that a picture has across: those of the window, or of paper. */
let paper = null;
function roomOf(host) {
  return Math.max(290, paper ?? host.clientWidth);
}
