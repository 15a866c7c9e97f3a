// What a chart shows of its table, and where each row stands: the rules of src/report/chart/view.rs.

const MOST_BANDS = 4;
const MOST_WHISKERS = 80;

/** Rows by the values of columns: names of the groups, and the group of each row. */
function groupsOf(columns, rows) {
  const known = new Map();
  const firsts = [];
  let of = rows.map((row) => {
    const key = columns.map((column) => column.levels.codes[row]).join();
    if (!known.has(key)) {
      known.set(key, firsts.length);
      firsts.push(row);
    }
    return known.get(key);
  });
  if (columns.length === 1 && columns[0].isNumber) {
    const order = firsts.map((_, group) => group).sort((a, b) => columns[0].levels.codes[firsts[a]] - columns[0].levels.codes[firsts[b]]);
    const place = new Map(order.map((old, now) => [old, now]));
    of = of.map((group) => place.get(group));
    firsts.splice(0, firsts.length, ...order.map((old) => firsts[old]));
  }
  const names = firsts.map((row) => columns.map((column) => column.say(column.value(row))).join(", "));
  const titles = firsts.map((row) => columns.map((column) => (column.isNumber ? column.phrase(column.value(row)) : column.say(column.value(row)))).join(", "));
  return { heading: columns.map((column) => column.words).join(", "), names, titles, of };
}

class View {
  /** Of a spec's rows among those that are given. */
  constructor(spec, table, rows, fitted = false) {
    Object.assign(this, { spec, table, rows });
    const column = (name) => table.column(name);
    this.kind = typeof spec.mark === "string" ? spec.mark : "tiles";
    this.lines = groupsOf(spec.lines.map(column), rows);
    this.panels = groupsOf(spec.panels ? [column(spec.panels)] : [], rows);
    const x = spec.x_is?.name === spec.x ? column(spec.x).as(spec.x_is) : column(spec.x);
    const y = column(spec.y);
    const interval = (y.interval ?? []).map(column);
    const bounds = interval.length === 2 && interval.every(Boolean) ? interval : null;
    const along = { x: rows.map((row) => x.value(row)), y: rows.map((row) => y.value(row)) };
    for (const bound of bounds ?? []) along.y.push(...rows.map((row) => bound.value(row)));
    for (const rule of spec.rules) along[rule.along].push(...("value" in rule.at ? [rule.at.value] : rows.map((row) => column(rule.at.column).value(row))));
    const scale = (column, which) => (this.kind === "tiles" || !column.isNumber ? levelScale(column, rows, which, this.kind === "tiles" && which === "x" ? y : null) : scaleOf(column, along[which], which, fitted));
    this.x = scale(x, "x");
    this.y = scale(y, "y");
    this.places = [];
    rows.forEach((row, number) => {
      const place = { row, panel: this.panels.of[number], line: this.lines.of[number], x: this.x.place(x.value(row)), y: this.y.place(y.value(row)), ends: null };
      if (place.x === null || place.y === null) return;
      place.x += this.beside(place.line);
      if (bounds) place.ends = bounds.map((bound) => this.y.place(bound.value(row)));
      if (place.ends?.includes(null)) place.ends = null;
      this.places.push(place);
    });
    this.places.sort((a, b) => a.panel - b.panel || a.line - b.line || a.x - b.x);
    this.isJoined = this.kind !== "points" && this.kind !== "tiles" && !this.x.isWords && !x.hasNamedNumbers;
    const hasEnds = this.places.some((place) => place.ends);
    this.hasBands = hasEnds && this.isJoined && this.lines.names.length <= MOST_BANDS;
    this.hasWhiskers = hasEnds && !this.hasBands && !(this.kind === "points" && this.places.length > MOST_WHISKERS);
    this.fronts = spec.front ? this.allFronts() : [];
    this.onFront = new Set(this.fronts.flatMap((front) => front.places.map((place) => place.row)));
  }

  /** Lines stand beside each other at a word. */
  beside(line) {
    if (!this.x.isWords || this.kind !== "line") return 0;
    const n = this.lines.names.length;
    return (Math.min(0.14, 0.6 / n) / this.x.n) * (line - 0.5 * (n - 1));
  }

  get moreIsBetter() {
    return this.table.column(this.spec.y).better !== "less";
  }

  /** The Pareto front of each panel and condition, along x. */
  allFronts() {
    const up = this.moreIsBetter ? 1 : -1;
    const byRow = new Map(this.places.map((place) => [place.row, place]));
    const fronts = [];
    for (const panel of this.panels.names.keys()) {
      const rows = this.places.filter((place) => place.panel === panel).map((place) => place.row);
      for (const condition of this.table.byCondition(rows)) {
        const order = condition.rows.map((row) => byRow.get(row)).sort((a, b) => a.x - b.x || up * (b.y - a.y));
        let best = null;
        const places = order.filter((place) => {
          const on = best === null || up * (place.y - best.y) > 0 || (place.x === best.x && place.y === best.y);
          if (on) best = place;
          return on;
        });
        fronts.push({ panel, places });
      }
    }
    return fronts;
  }

  /** Where a rule runs in a panel: lists of [x, y]. */
  ruleLines(rule, inPanel) {
    const [own, other] = rule.along === "x" ? [this.x, "y"] : [this.y, "x"];
    const point = (at, along) => (rule.along === "x" ? [at, along] : [along, at]);
    const across = (at) => [point(at, 0), point(at, 1)];
    if ("value" in rule.at) return [own.place(rule.at.value)].filter((at) => at !== null).map(across);
    const column = this.table.column(rule.at.column);
    const found = new Map();
    for (const place of this.places.filter(inPanel)) {
      const at = own.place(column.value(place.row));
      if (at !== null) found.set(`${place[other]},${at}`, [place[other], at]);
    }
    const places = [...found.values()].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    const isFunction = places.every(([along], k) => k === 0 || along !== places[k - 1][0]);
    const levels = [...new Set(places.map(([, at]) => at))];
    if (levels.length === 1 || !isFunction) return levels.map(across);
    const half = 0.5 / (rule.along === "x" ? this.y : this.x).n;
    if (this.kind === "tiles") return [places.flatMap(([along, at]) => [point(at, along - half), point(at, along + half)])];
    return [places.map(([along, at]) => point(at, along))];
  }
}
