// Scales, ticks, markers and legends of charts.

const SHAPES = [
  "M-4,0a4,4 0 1,0 8,0a4,4 0 1,0 -8,0",
  "M-3.6,-3.6h7.2v7.2h-7.2z",
  "M0,-4.8L4.6,3.6H-4.6z",
  "M0,-5L5,0L0,5L-5,0z",
  "M0,4.8L4.6,-3.6H-4.6z",
  "M-4.6,-1.5h3.1v-3.1h3v3.1h3.1v3h-3.1v3.1h-3v-3.1h-3.1z",
  "M-4.8,0L-1.5,-4.2h3L4.8,0L1.5,4.2h-3z",
  "M-4.2,-4.2h2.2L0,-2L2,-4.2h2.2v2.2L2,0L4.2,2v2.2H2L0,2L-2,4.2h-2.2V2L-2,0L-4.2,-2z",
];
const DASHES = [null, "7 4", "2 4", "9 3 2 3"];

/** Colour and shape number `line`; past eight, colours come again with other dashes. */
function look(line) {
  return { colour: `var(--c${line % 8})`, shape: SHAPES[line % 8], dashes: DASHES[Math.floor(line / 8) % 4] };
}

function marker(line, x, y, more = {}) {
  return draw("path", { d: look(line).shape, transform: `translate(${x.toFixed(1)},${y.toFixed(1)})`, fill: look(line).colour, ...more });
}

/** Where the values of an axis stand between two places. */
function valueScale(axis, levels, from, to) {
  const { numbers, scale } = axes[axis];
  const bend = { log: Math.log, sqrt: Math.sqrt, linear: (n) => n, words: (n) => n }[scale];
  const at = (level) => bend(scale === "words" ? levels.indexOf(level) : numbers[level]);
  const places = levels.map(at);
  const [low, high] = [Math.min(...places), Math.max(...places)];
  const margin = 0.06 * (to - from);
  return (level) => (high > low ? from + margin + ((at(level) - low) / (high - low)) * (to - from - 2 * margin) : (from + to) / 2);
}

/** A logarithmic axis of seconds, and its ticks: 1, 2 and 5 of each decade as far as there is room. */
function timeScale(seconds, from, to) {
  const [low, high] = [0.7 * Math.min(...seconds), 1.4 * Math.max(...seconds)];
  const at = (time) => from + (Math.log(time / low) / Math.log(high / low)) * (to - from);
  const decades = Math.log10(high / low);
  const digits = (to - from) / decades > 150 ? [1, 2, 5] : [1];
  const ticks = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
    for (const digit of digits) {
      const time = digit * 10 ** power;
      if (time >= low && time <= high) ticks.push([at(time), duration(time)]);
    }
  }
  return { at, ticks };
}

/** From 0 to 1, or round numbers around what is shown. */
function accuracyRange(lows, highs, fitted) {
  if (!fitted) return { low: 0, high: 1, step: 0.2 };
  const [least, most] = [Math.min(...lows), Math.max(...highs)];
  const step = [0.01, 0.02, 0.05, 0.1, 0.2].find((step) => (most - least) / step <= 6) || 0.2;
  const low = Math.max(0, Math.floor(least / step) * step);
  return { low, high: Math.min(1, Math.max(Math.ceil(most / step) * step, low + step)), step };
}

/** An empty panel: grid, ticks and titles. Says where an accuracy stands. */
function panel({ width, height, ticks, range, xTitle, label, title }) {
  const box = { left: 52, right: width - 12, top: title ? 30 : 10, bottom: height - 46 };
  const at = (accuracy) => box.bottom - ((accuracy - range.low) / (range.high - range.low)) * (box.bottom - box.top);
  const svg = draw("svg", {
    viewBox: `0 0 ${width} ${height}`, tabindex: 0, role: "group", "aria-roledescription": "chart",
    "aria-label": `${label}. The arrow keys go from point to point; the table of all cells below holds the same numbers.`,
  });
  if (title) svg.append(draw("text", { x: box.left, y: 18, class: "panel-title" }, title));
  for (let value = range.low; value <= range.high + 1e-9; value += range.step) {
    svg.append(draw("line", { x1: box.left, x2: box.right, y1: at(value), y2: at(value), class: "grid" }));
    svg.append(draw("text", { x: box.left - 8, y: at(value) + 4, class: "tick end" }, value.toFixed(range.step < 0.1 ? 2 : 1)));
  }
  let freeFrom = -Infinity;
  for (const [x, text] of ticks) {
    svg.append(draw("line", { x1: x, x2: x, y1: box.top, y2: box.bottom + 5, class: "grid" }));
    const half = 3.6 * text.length;
    if (x - half < freeFrom) continue;
    freeFrom = x + half + 5;
    svg.append(draw("text", { x: Math.min(x, width - half - 1), y: box.bottom + 19, class: "tick middle" }, text));
  }
  const { left, right, top, bottom } = box;
  svg.append(draw("path", { d: `M${left},${top}V${bottom}H${right}`, class: "frame" }));
  svg.append(draw("text", { x: (left + right) / 2, y: height - 6, class: "axis-title middle" }, xTitle));
  const turned = `rotate(-90 13 ${(top + bottom) / 2})`;
  svg.append(draw("text", { x: 13, y: (top + bottom) / 2, transform: turned, class: "axis-title middle" }, "accuracy"));
  if (study.chance !== null && study.chance >= range.low) {
    svg.append(draw("line", { x1: left, x2: right, y1: at(study.chance), y2: at(study.chance), class: "chance" }));
  }
  return { svg, box, at };
}

/** A line of a legend: a small picture and what it stands for. */
function legendEntry(text, ...shapes) {
  return make("span", { class: "entry" }, draw("svg", { viewBox: "-14 -8 28 16", width: 28, height: 16, "aria-hidden": "true" }, ...shapes), text);
}

function chanceEntry() {
  return legendEntry(`chance (1 in ${Math.round(1 / study.chance)})`, draw("path", { d: "M-13,0H13", class: "chance" }));
}
