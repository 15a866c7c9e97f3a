// The tables of a study, and how their values are said: as columns say it in Rust.

const study = JSON.parse(document.getElementById("study").textContent);
const SWEPT = ["choice", "condition", "subject"];

/** Four significant digits, no trailing zeros. */
function short(number) {
  if (number === 0) return "0";
  const digits = Math.floor(Math.log10(Math.abs(number))) + 1;
  if (digits < -3 || digits > 6) return number.toExponential(2).replace(".00e", "e").replace("e+", "e");
  return String(Number(number.toFixed(Math.max(0, 4 - digits))));
}

/** Seconds in the unit that suits them. */
function duration(seconds) {
  if (seconds === 0) return "0 s";
  const size = Math.abs(seconds);
  const [factor, unit] = size < 0.999e-6 ? [1e9, "ns"] : size < 0.999e-3 ? [1e6, "µs"] : size < 0.999 ? [1e3, "ms"] : [1, "s"];
  return `${Number((seconds * factor).toPrecision(3))} ${unit}`;
}

class Column {
  constructor(about, data, n) {
    Object.assign(this, { name: about.name, words: about.words, unit: about.unit, scale: about.scale, interval: about.interval });
    this.role = typeof about.role === "string" ? about.role : Object.keys(about.role)[0];
    this.better = about.role.value ?? (this.role === "cost" ? "less" : "neither");
    this.names = new Map(about.names ?? []);
    this.isNumber = about.scale !== "words";
    this.seconds = about.scale === "log" ? { s: 1, ms: 1e-3, us: 1e-6, "µs": 1e-6 }[about.unit] : undefined;
    this.isSame = data.codes?.length === 0;
    if (this.isSame) this.values = Array(n).fill(data.levels[0]);
    else if (data.levels) this.values = data.codes.map((code) => data.levels[code]);
    else this.values = data;
  }

  /** The same values, said as another column says them. */
  as(about) {
    return new Column(about, this.values, this.values.length);
  }

  value(row) {
    return this.values[row];
  }

  isAbsent(row) {
    return this.values[row] === null || this.values[row] === "";
  }

  /** Its values, each once: numbers rising, words in the order of first rows; and the number of each row's among them. */
  get levels() {
    if (!this.found) {
      let each = [...new Set(this.values)];
      if (this.isNumber) each = each.filter((value) => value !== null).sort((a, b) => a - b).concat(each.includes(null) ? [null] : []);
      const code = new Map(each.map((value, place) => [value, place]));
      this.found = { each, labels: each.map((value) => this.say(value)), codes: this.values.map((value) => code.get(value)) };
    }
    return this.found;
  }

  get varies() {
    return !this.isSame && this.levels.each.length > 1;
  }

  get isSwept() {
    return SWEPT.includes(this.role);
  }

  get title() {
    return this.unit === "" || this.unit === ":1" || this.seconds ? this.words : `${this.words} (${this.unit})`;
  }

  /** Whether it has numbers that are more than numbers: between these and others there is nothing. */
  get hasNamedNumbers() {
    return this.isNumber && [...this.names.keys()].some((code) => code !== "");
  }

  tick(number) {
    const name = this.names.get(short(number));
    if (name !== undefined) return name;
    if (this.unit === "%") return short(Math.round(number * 1e8) / 1e6);
    if (this.unit === ":1") return `${short(number)}:1`;
    return this.seconds ? duration(number * this.seconds) : short(number);
  }

  /** A value for a sentence. */
  say(value) {
    if (value === null || value === "") return this.names.get("") ?? "none";
    if (!this.isNumber) return this.names.get(value) ?? value.replaceAll("_", " ");
    const isWhole = this.unit === "" || this.unit === ":1" || this.seconds || this.names.has(short(value));
    const unit = this.unit === "bits" && value === 1 ? "bit" : this.unit;
    return isWhole ? this.tick(value) : `${this.tick(value)} ${unit}`;
  }

  phrase(value) {
    return `${this.words}${[...this.words].length === 1 ? " = " : " "}${this.say(value)}`;
  }
}

class Table {
  constructor(raw) {
    Object.assign(this, { file: raw.file, title: raw.title, n: raw.n });
    this.columns = raw.columns.map((about, place) => new Column(about, raw.data[place], raw.n));
    this.byName = new Map(this.columns.map((column) => [column.name, column]));
    this.all = Array.from({ length: raw.n }, (_, row) => row);
  }

  column(name) {
    return this.byName.get(name);
  }

  /** Columns that a reader may choose values of. */
  get swept() {
    return this.columns.filter((column) => column.isSwept && column.varies);
  }

  /** What tells a row from the others, in words. */
  place(row, without = []) {
    const columns = this.swept.filter((column) => !column.isAbsent(row) && !without.includes(column.role));
    return columns.map((column) => (column.isNumber ? column.phrase(column.value(row)) : column.say(column.value(row)))).join(" · ");
  }

  /** A value with its interval. */
  bounded(column, row) {
    const ends = (column.interval ?? []).map((name) => this.column(name)?.value(row)).filter((end) => end !== null && end !== undefined);
    return column.say(column.value(row)) + (ends.length === 2 ? ` [${ends.map((end) => column.tick(end)).join(", ")}]` : "");
  }

  /** What a reader wants to know of a row, a line each. */
  describe(row) {
    const told = this.columns.filter((column) => ["value", "cost", "outcome"].includes(column.role) && !column.isAbsent(row));
    return { title: this.place(row) || this.title, lines: told.map((column) => `${column.words} ${this.bounded(column, row)}`) };
  }

  /** Rows by the conditions of the world, which nobody chooses. */
  byCondition(rows) {
    const conditions = this.columns.filter((column) => column.role === "condition" && column.varies);
    const found = new Map();
    for (const row of rows) {
      const key = conditions.map((column) => column.levels.codes[row]).join();
      if (!found.has(key)) found.set(key, []);
      found.get(key).push(row);
    }
    return [...found.values()].map((rows) => ({ rows, words: conditions.map((column) => column.phrase(column.value(rows[0]))).join(", ") }));
  }
}

const tables = study.tables.map((raw) => new Table(raw));
const tableOf = (file) => tables.find((table) => table.file === file);

/** A labelled choice of one of some values. */
function choice(label, options, chosen, changed) {
  const select = make("select", { change: () => changed(options[select.selectedIndex][0]) });
  for (const [, text] of options) select.append(make("option", {}, text));
  select.selectedIndex = Math.max(0, options.findIndex(([value]) => value === chosen));
  return { element: make("label", { class: "choice" }, make("span", {}, label), select), select };
}
