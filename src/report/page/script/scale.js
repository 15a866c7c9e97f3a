// Where values stand along an axis, as parts of its length: the rules of src/report/chart/scale.rs.

const SHELF = 0.09;

/** 1, 2 or 5 times a power of ten: about five steps over a length. */
function tickStep(length) {
  const raw = length / 5;
  const power = 10 ** Math.floor(Math.log10(raw));
  return ([1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999) ?? 10) * power;
}

function evenTicks(low, high) {
  const step = tickStep(high - low);
  const [first, last] = [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
  return Array.from({ length: last - first + 1 }, (_, k) => (step < 1 ? (first + k) / Math.round(1 / step) : (first + k) * step));
}

function logTicks(low, high) {
  const multiples = (factors) => {
    const ticks = [];
    for (let power = Math.floor(low); power <= Math.ceil(high); power++) ticks.push(...factors.map((factor) => Number(`${factor}e${power}`)));
    return ticks.filter((tick) => Math.log10(tick) >= low && Math.log10(tick) <= high);
  };
  return [[1], [1, 2, 5]].map(multiples).find((ticks) => ticks.length >= 3) ?? evenTicks(10 ** low, 10 ** high);
}

function endsOf(values) {
  const [low, high] = [values[0] ?? 0, values.at(-1) ?? 1];
  const room = 0.5 * Math.max(Math.abs(low), 1e-12);
  return high > low ? [low, high] : [low - room, low + room];
}

function roundEnds(values) {
  let [low, high] = endsOf(values);
  if (low > 0 && low < 0.6 * high) low = 0;
  if (high < 0 && high > 0.6 * low) high = 0;
  const step = tickStep(high - low);
  return [step * Math.floor(low / step + 1e-9), step * Math.ceil(high / step - 1e-9)];
}

/** Of the values of a column: `place` of a value (null for none), ticks, and what the axis is. */
function scaleOf(column, values, along, fitted) {
  const numbers = [...new Set(values.filter((value) => value !== null))].sort((a, b) => a - b);
  const [kind, low, high] = endsAlong(column, numbers, along, fitted);
  const hasZero = kind === "log" && numbers.includes(0);
  const shelf = hasZero ? SHELF : 0;
  const place = (value) => {
    if (value === null || value === undefined) return null;
    if (kind === "log" && value === 0) return hasZero ? SHELF / 2 : null;
    const part = kind === "log" ? shelf + ((1 - shelf) * (Math.log10(value) - low)) / (high - low) : (value - low) / (high - low);
    return part >= -1e-9 && part <= 1 + 1e-9 ? Math.min(1, Math.max(0, part)) : null;
  };
  let wanted = numbers;
  if (!column.isSwept || numbers.length > 40) wanted = kind === "log" ? [...(hasZero ? [0] : []), ...logTicks(low, high)] : evenTicks(low, high);
  const isRound = (value) => kind === "log" && Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9;
  const ticks = wanted.filter((value) => place(value) !== null).map((value) => ({ at: place(value), label: column.tick(value), round: isRound(value) }));
  return { place, ticks, title: column.title, isWords: false, shelf: hasZero ? SHELF : null, n: 1 };
}

function endsAlong(column, numbers, along, fitted) {
  if (column.scale === "log") {
    const positive = numbers.filter((value) => value > 0);
    const [low, high] = positive.length ? [Math.log10(positive[0]), Math.log10(positive.at(-1))] : [-1, 1];
    const margin = Math.max(0.06 * (high - low), 0.08);
    return ["log", low - margin, high + margin];
  }
  if (along === "y" && !column.isSwept) {
    const [low, high] = roundEnds(numbers);
    return column.scale === "share" && column.unit === "" && !fitted ? ["even", Math.min(low, 0), Math.max(high, 1)] : ["even", low, high];
  }
  const [low, high] = endsOf(numbers);
  return ["even", low - 0.06 * (high - low), high + 0.06 * (high - low)];
}

/** Words at equal distances, rows from above; and numbers of tiles. */
function levelScale(column, rows, along, other) {
  const shown = new Set(rows.map((row) => column.levels.codes[row]));
  const each = column.levels.each.map((_, code) => code).filter((code) => shown.has(code) && column.levels.each[code] !== null);
  // What is alike in rows and columns lies on the diagonal.
  if (other && !column.isNumber && !other.isNumber) {
    const rank = (code) => other.levels.each.indexOf(column.levels.each[code]);
    each.sort((a, b) => (rank(a) < 0 ? Infinity : rank(a)) - (rank(b) < 0 ? Infinity : rank(b)) || a - b);
  }
  const fromAbove = along === "y" && !column.isNumber;
  const at = (position) => (fromAbove ? 1 - (position + 0.5) / each.length : (position + 0.5) / each.length);
  const position = new Map(each.map((code, place) => [column.levels.each[code], place]));
  const spaced = (value) => (column.scale === "log" ? Math.log(value) : value);
  const between = (value) => {
    if (position.has(value)) return position.get(value);
    const levels = each.map((code) => column.levels.each[code]);
    if (!column.isNumber || value === null) return null;
    if (levels.length === 1) return value < levels[0] ? -0.5 : 0.5;
    const above = Math.max(1, levels.findIndex((level) => level > value) + 1 ? levels.findIndex((level) => level > value) : levels.length - 1);
    return above - 1 + (spaced(value) - spaced(levels[above - 1])) / (spaced(levels[above]) - spaced(levels[above - 1]));
  };
  const place = (value) => {
    const found = between(value);
    return found === null || found === undefined ? null : at(Math.min(Math.max(found, -0.5), each.length - 0.5));
  };
  const label = (code) => (column.isNumber ? column.tick(column.levels.each[code]) : column.levels.labels[code]);
  return { place, ticks: each.map((code, k) => ({ at: at(k), label: label(code) })), title: column.title, isWords: !column.isNumber, shelf: null, n: each.length };
}

/** Ticks with room for their labels, each taking `half` of the axis to either side: the ends first, then round ones, then in order. */
function thin(ticks, half) {
  const rank = (place) => (place === 0 || place === ticks.length - 1 ? 0 : ticks[place].round ? 1 : 2);
  const order = ticks.map((_, place) => place).sort((a, b) => rank(a) - rank(b) || a - b);
  const taken = [];
  const kept = order.filter((place) => {
    const [from, to] = [ticks[place].at - half(ticks[place]), ticks[place].at + half(ticks[place])];
    const isFree = taken.every(([a, b]) => to <= a || from >= b);
    if (isFree) taken.push([from, to]);
    return isFree;
  });
  return kept.sort((a, b) => a - b).map((place) => ticks[place]);
}
