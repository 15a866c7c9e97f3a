// What every part of the page uses: the data, numbers as people write them.

const study = JSON.parse(document.getElementById("study").textContent);
const { axes, cells } = study;
const allCells = cells.accuracy.map((_, place) => place);
const free = axes.map((_, axis) => axis).filter((axis) => !axes[axis].follows);
const severalConditions = study.conditions.length > 1;
const MINUS = "\u2212";

/** Four digits that count, as everywhere in the report. */
function short(number) {
  const size = Math.abs(number);
  if (number === 0) return "0";
  return size >= 1e6 || size < 1e-3 ? number.toExponential(2) : String(Number(number.toPrecision(4)));
}

function signed(number, digits) {
  return (number < 0 ? MINUS : "+") + Math.abs(number).toFixed(digits);
}

/** Seconds in a unit that suits them. */
function duration(seconds) {
  const units = [[1, "s"], [1e-3, "ms"], [1e-6, "µs"], [1e-9, "ns"]];
  const [size, unit] = units.find(([size]) => seconds >= size * 0.9995) || units[3];
  return `${Number((seconds / size).toPrecision(3))} ${unit}`;
}

function chanceValue(p) {
  return p < 0.001 ? "< 0.001" : p.toFixed(3);
}

/** The value of an axis in a cell: its number among the axis's values. */
function levelOf(axis, cell) {
  return cells.levels[axis][cell];
}

/** The settings of a cell that vary, in words. */
function place(cell) {
  return axes.map((axis, number) => axis.phrases[levelOf(number, cell)]).join(" · ");
}

/** Those of them that a designer decides. */
function choicesOf(cell) {
  const phrases = axes.map((axis, number) => (axis.condition ? null : axis.phrases[levelOf(number, cell)]));
  return phrases.filter((phrase) => phrase !== null).join(" · ");
}

function accuracyText(cell) {
  const [value, low, high] = [cells.accuracy, cells.low, cells.high].map((column) => column[cell].toFixed(3));
  return `${value} [${low}, ${high}]`;
}

/** Cells by their condition, in the order of the study's. */
function byCondition(shown) {
  const found = study.conditions.map(() => []);
  for (const cell of shown) found[cells.condition[cell]].push(cell);
  return found.filter((condition) => condition.length > 0);
}

/** What a reader wants to know of a cell, a line each. */
function describe(cell) {
  const trials = cells.n_trials[cell];
  const lines = [
    `accuracy ${accuracyText(cell)} (95 %)`,
    `n = ${cells.n_test[cell]} test decisions` + (trials > 1 ? `, mean of ${trials} trials` : ""),
  ];
  const difference = cells.difference[cell];
  if (cell === cells.best[cell]) lines.push(severalConditions ? "the best cell of its condition" : "the best cell");
  else if (difference !== null) {
    const p = cells.p[cell];
    lines.push(`${signed(difference, 3)} to the best` + (p === null ? (study.too_few_trials ? ", too few trials for p" : "") : `, ${study.p} ${p < 0.001 ? "< 0.001" : "= " + p.toFixed(3)}`));
  }
  if (cells.decide_us[cell] !== null) {
    lines.push(`${duration(1e-6 * cells.decide_us[cell])} a decision, ${duration(cells.fit_s[cell])} to train`);
  }
  return { title: `Cell ${cells.cell[cell]}: ${place(cell) || "the only one"}`, lines };
}

/** Pixels that a picture has across: those of the window, or of paper. */
let paper = null;
function roomOf(host) {
  return Math.max(290, paper ?? host.clientWidth);
}

/** A labelled choice. */
function choice(label, options, chosen, changed) {
  const select = make("select", { change: () => changed(Number(select.value)) });
  for (const [value, text] of options) select.append(make("option", { value }, text));
  select.value = chosen;
  return { element: make("label", { class: "choice" }, make("span", {}, label), select), select };
}
